uniform mat4 world_to_clip;
uniform vec2 picture;
uniform float width;
uniform vec3 slab_normal;
in vec3 start;
in vec3 end;
in vec2 corner;
in vec4 colour;
out vec4 body;
out float off_centre_times_w;
out float along_normal;

void main() {
    const float NEAR = 1e-2;
    body = colour;
    // The strip is as long as the line, and depth is counted in here: it is straight in space.
    along_normal = dot(slab_normal, corner.x < 0.5 ? start : end);
    vec4 a = world_to_clip * vec4(start, 1.0);
    vec4 b = world_to_clip * vec4(end, 1.0);
    if (a.w < NEAR && b.w < NEAR) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
        off_centre_times_w = 0.0;
        return;
    }
    // What lies behind the eye has no place in the picture.
    vec4 a_seen = a.w < NEAR ? mix(a, b, (NEAR - a.w) / (b.w - a.w)) : a;
    vec4 b_seen = b.w < NEAR ? mix(b, a, (NEAR - b.w) / (a.w - b.w)) : b;
    if (corner.x < 0.5 && a.w < NEAR)
        along_normal = dot(slab_normal, mix(start, end, (NEAR - a.w) / (b.w - a.w)));
    if (corner.x > 0.5 && b.w < NEAR)
        along_normal = dot(slab_normal, mix(end, start, (NEAR - b.w) / (a.w - b.w)));
    vec2 a_px = a_seen.xy / a_seen.w * picture * 0.5;
    vec2 b_px = b_seen.xy / b_seen.w * picture * 0.5;
    vec2 way = b_px - a_px;
    vec2 ahead = length(way) > 1e-4 ? normalize(way) : vec2(1.0, 0.0);
    float off_centre = corner.y * (0.5 * width + 1.0);
    vec4 here = corner.x < 0.5 ? a_seen : b_seen;
    vec2 here_px = (corner.x < 0.5 ? a_px : b_px) + vec2(-ahead.y, ahead.x) * off_centre;
    gl_Position = vec4(here_px / (picture * 0.5) * here.w, here.z, here.w);
    // The strip is flat in the picture, not in space: with w in it, the card interpolates it there.
    off_centre_times_w = off_centre * here.w;
}
