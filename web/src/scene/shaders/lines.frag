uniform float width;
uniform vec2 slab;
in vec4 body;
in float off_centre_times_w;
in float along_normal;
layout (location = 0) out vec4 shown;

void main() {
    if (along_normal < slab.x || along_normal > slab.y) discard;
    // gl_FragCoord.w is 1 / w.
    float off_centre = off_centre_times_w * gl_FragCoord.w;
    float cover = clamp(0.5 * width + 0.5 - abs(off_centre), 0.0, 1.0);
    if (cover < 0.02) discard;
    shown = vec4(body.rgb, body.a * cover);
}
