uniform mat4 world_to_clip;
uniform float size;
uniform float refraction;
uniform vec2 range;
in vec3 place;
in vec3 unrefracted;
in vec4 colour;
in float fraction;
out vec4 body;

void main() {
    body = colour;
    gl_Position = world_to_clip * vec4(mix(unrefracted, place, refraction), 1.0);
    if (fraction < range.x || fraction > range.y) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = size;
}
