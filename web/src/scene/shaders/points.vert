uniform mat4 world_to_clip;
uniform float size;
uniform float refraction;
uniform vec2 range;
uniform vec3 slab_normal;
uniform vec2 slab;
in vec3 place;
in vec3 unrefracted;
in uvec4 colour;
in float fraction;
out vec4 body;

void main() {
    body = vec4(colour) / 255.0;
    vec3 here = mix(unrefracted, place, refraction);
    float along = dot(slab_normal, here);
    gl_Position = world_to_clip * vec4(here, 1.0);
    bool hidden = fraction < range.x || fraction > range.y || along < slab.x || along > slab.y;
    if (hidden) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = size;
}
