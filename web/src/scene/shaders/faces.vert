uniform mat4 world_to_clip;
in vec3 place;
in vec4 colour;
out vec4 body;

void main() {
    body = colour;
    gl_Position = world_to_clip * vec4(place, 1.0);
}
