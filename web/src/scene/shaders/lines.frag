uniform float width;
in vec4 body;
in float off_centre;
in float along;
in float period;
layout (location = 0) out vec4 shown;

void main() {
    float cover = clamp(0.5 * width + 0.5 - abs(off_centre), 0.0, 1.0);
    if (cover < 0.02) discard;
    if (period > 0.0 && fract(along / period) > 0.55) discard;
    shown = vec4(body.rgb, body.a * cover);
}
