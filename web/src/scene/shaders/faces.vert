uniform mat4 world_to_clip;
uniform vec3 slab_normal;
in vec3 place;
in vec4 colour;
out vec4 body;
out float along;

void main() {
    body = colour;
    along = dot(slab_normal, place);
    gl_Position = world_to_clip * vec4(place, 1.0);
}
