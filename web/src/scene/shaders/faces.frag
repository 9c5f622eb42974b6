uniform vec2 slab;
in vec4 body;
in float along;
layout (location = 0) out vec4 shown;

void main() {
    if (along < slab.x || along > slab.y) discard;
    shown = body;
}
