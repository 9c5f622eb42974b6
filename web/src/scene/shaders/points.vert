uniform mat4 world_to_clip;
uniform float size;
uniform float refraction;
in vec3 place;
in vec3 unrefracted;
in vec4 colour;
out vec4 body;

void main() {
    body = colour;
    gl_Position = world_to_clip * vec4(mix(unrefracted, place, refraction), 1.0);
    gl_PointSize = size;
}
