uniform vec3 rim;
uniform float size;
uniform float ring;
in vec4 body;
layout (location = 0) out vec4 shown;

void main() {
    // From the point's centre, device px.
    float from_centre = length(gl_PointCoord - 0.5) * size;
    float radius = 0.5 * size - 0.5;
    float cover = clamp(radius + 0.5 - from_centre, 0.0, 1.0);
    float width = max(1.0, 0.13 * size);
    float at_rim = clamp(from_centre - (radius - width) + 0.5, 0.0, 1.0);
    if (ring > 0.5) {
        cover *= at_rim;
        if (cover < 0.02) discard;
        shown = vec4(body.rgb, body.a * cover);
        return;
    }
    if (cover < 0.02) discard;
    // A little light from above left: a disc reads as a ball.
    vec2 tilt = (gl_PointCoord - vec2(0.36, 0.32)) * 2.0;
    float light = 1.08 - 0.22 * dot(tilt, tilt);
    shown = vec4(mix(body.rgb * light, rim, 0.5 * at_rim), body.a * cover);
}
