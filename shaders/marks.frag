// Writes the display colours of marks; alpha is above 0 in their pixels.
in vec4 colour;
layout(location = 0) out vec4 shown;

void main() { shown = colour; }
