// Rounds a colour to 8 bits: integers from 0 to 255.
vec3 in_bytes(vec3 colour) { return floor(clamp(colour, 0.0, 1.0) * 255.0 + 0.5); }
