in vec4 body;
layout (location = 0) out vec4 shown;

void main() {
    shown = body;
}
