// Their colours as they are, and an alpha above 0 where there is one.
in vec4 colour;
layout(location = 0) out vec4 shown;

void main() { shown = colour; }
