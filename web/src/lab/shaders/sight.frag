// The eye's picture through the wall: each pixel's ray is bent at every face as Snell's law says, by the same
// steps as the core's `Stack::trace`. Built with PROBE it gives, in place of colours, where rays land.

uniform vec3 eye;
uniform mat3 world_from_eye;
// Focal length and the picture's middle, px; (0, 0) is the centre of the top-left pixel.
uniform vec3 lens;
uniform float picture_height;
// Left of this, px, the vessel is filled.
uniform float divider;
// 0: flat, 1: round about an upright axis, 2: a ball.
uniform int wall;
uniform float radius;
uniform float thickness;
// Around the eye, the wall, the liquid.
uniform vec3 indices;
// The rim, the liquid's surface, the floor: y, downwards.
uniform vec3 level;
// Half a flat tank's width, and its depth.
uniform vec2 tank;
uniform vec3 middle;
// 0: rod, 1: ball, 2: card.
uniform int thing;
uniform vec3 thing_from;
uniform vec3 thing_to;
uniform float thing_radius;
uniform float dark;
#ifdef PROBE
// The first pixel to try, and the steps to the others.
uniform vec4 probe;
layout (location = 0) out uvec4 landed;
#else
layout (location = 0) out vec4 shown;
#endif

const float NONE = 1e9;
const float TOUCHING = 1e-3;

// Where a ray went: what it reached in the liquid straight behind the wall, for the probe.
bool straight_in_liquid;
vec3 reached;

vec3 bend(vec3 light, vec3 normal, float n1, float n2, out bool thrown_back) {
    vec3 facing = dot(light, normal) > 0.0 ? -normal : normal;
    vec3 bent = refract(light, facing, n1 / n2);
    thrown_back = dot(bent, bent) < 0.5;
    return thrown_back ? reflect(light, facing) : normalize(bent);
}

// Across a round wall's axis; a ball has none.
vec3 across(vec3 way) {
    return wall == 1 ? vec3(way.x, 0.0, way.z) : way;
}

vec3 centre() {
    return vec3(0.0, 0.0, radius);
}

float nearer(vec3 from, vec3 light, float r) {
    vec3 o = across(from - centre()), d = across(light);
    float a = dot(d, d), half_b = dot(o, d), c = dot(o, o) - r * r;
    float discriminant = half_b * half_b - a * c;
    if (half_b >= 0.0 || discriminant < 0.0) return NONE;
    return c / (sqrt(discriminant) - half_b);
}

float farther(vec3 from, vec3 light, float r) {
    vec3 o = across(from - centre()), d = across(light);
    float a = dot(d, d), half_b = dot(o, d), c = dot(o, o) - r * r;
    return (sqrt(max(half_b * half_b - a * c, 0.0)) - half_b) / a;
}

vec3 round_normal(vec3 at) {
    return normalize(across(at - centre()));
}

// --- What stands in the vessel ---

float rod(vec3 from, vec3 light, out vec3 normal) {
    vec3 axis = thing_to - thing_from, o = from - thing_from;
    float dd = dot(axis, axis), dl = dot(axis, light), doo = dot(axis, o);
    float a = dd - dl * dl, b = dd * dot(o, light) - doo * dl;
    float c = dd * dot(o, o) - doo * doo - thing_radius * thing_radius * dd;
    float h = b * b - a * c;
    if (h < 0.0) return NONE;
    float t = (-b - sqrt(h)) / a;
    float along = doo + t * dl;
    if (t < TOUCHING || along < 0.0 || along > dd) return NONE;
    normal = normalize(o + light * t - axis * (along / dd));
    return t;
}

float ball(vec3 from, vec3 light, out vec3 normal) {
    vec3 o = from - thing_from;
    float half_b = dot(o, light), h = half_b * half_b - dot(o, o) + thing_radius * thing_radius;
    if (h < 0.0) return NONE;
    float t = -half_b - sqrt(h);
    normal = normalize(o + light * t);
    return t < TOUCHING ? NONE : t;
}

float card(vec3 from, vec3 light, out vec3 normal) {
    float t = (thing_from.z - from.z) / light.z;
    vec3 at = from + light * t - thing_from;
    normal = vec3(0.0, 0.0, -1.0);
    return t < TOUCHING || abs(at.x) > thing_radius || abs(at.y) > thing_radius ? NONE : t;
}

float hit_thing(vec3 from, vec3 light, out vec3 normal) {
    if (thing == 0) return rod(from, light, normal);
    if (thing == 1) return ball(from, light, normal);
    return card(from, light, normal);
}

// --- Colours ---

vec3 lit(vec3 colour, vec3 normal) {
    const vec3 LAMP = vec3(-0.45, -0.72, -0.53);
    return colour * (0.64 + 0.42 * max(dot(normal, LAMP), 0.0));
}

vec3 thing_colour(vec3 at, vec3 normal) {
    const vec3 WHITE = vec3(0.97, 0.96, 0.93);
    vec3 local = at - thing_from;
    if (thing == 0) {
        float along = dot(local, normalize(thing_to - thing_from));
        return lit(mod(along, 24.0) < 12.0 ? vec3(0.86, 0.24, 0.11) : WHITE, normal);
    }
    if (thing == 1) {
        float round_about = atan(normal.x, -normal.z) / 0.5235988, up = asin(normal.y) / 0.5235988;
        bool odd = mod(floor(round_about) + floor(up), 2.0) > 0.5;
        return lit(odd ? vec3(0.05, 0.45, 0.58) : WHITE, normal);
    }
    bool odd = mod(floor(local.x / 10.0) + floor(local.y / 10.0), 2.0) > 0.5;
    vec3 square = odd ? vec3(0.10, 0.16, 0.20) : WHITE;
    float from_middle = length(local.xy);
    return from_middle < 5.0 ? vec3(0.86, 0.24, 0.11) : square;
}

// A thin line wherever a coordinate is a multiple of `step`.
float ruled(float coordinate, float step, float width) {
    float off = abs(mod(coordinate + 0.5 * step, step) - 0.5 * step);
    return 1.0 - smoothstep(0.5 * width, 0.5 * width + 0.6, off);
}

vec3 back_colour(vec3 at) {
    vec3 paper = mix(vec3(0.93, 0.95, 0.96), vec3(0.23, 0.29, 0.33), dark);
    vec3 ink = mix(vec3(0.55, 0.66, 0.72), vec3(0.42, 0.52, 0.58), dark);
    float lines = max(ruled(at.x, 20.0, 0.8), ruled(at.y, 20.0, 0.8));
    return mix(paper, ink, lines);
}

vec3 room(vec3 from, vec3 light) {
    vec3 far = mix(vec3(0.86, 0.89, 0.91), vec3(0.10, 0.13, 0.16), dark);
    vec3 near = mix(vec3(0.78, 0.75, 0.70), vec3(0.17, 0.16, 0.15), dark);
    float backdrop = 2.0 * middle.z + 90.0;
    float t_back = light.z > 1e-4 ? (backdrop - from.z) / light.z : NONE;
    float t_table = light.y > 1e-4 ? (level.z - from.y) / light.y : NONE;
    if (t_table < t_back && t_table > -TOUCHING) {
        vec3 at = from + light * t_table;
        return near * (1.0 - 0.25 * smoothstep(0.0, 400.0, length(at.xz - middle.xz)));
    }
    if (t_back >= NONE) return far;
    vec3 at = from + light * t_back;
    vec3 colour = far * (1.0 - 0.10 * smoothstep(0.0, 260.0, length(at.xy)));
    if (wall == 0) return colour;
    // An arrow on the wall behind a jar, which the full jar turns round.
    vec2 p = vec2(at.x, at.y + 6.0);
    bool shaft = abs(p.y) < 7.0 && p.x > -60.0 && p.x < 30.0;
    bool head = p.x >= 30.0 && p.x < 62.0 && abs(p.y) < (62.0 - p.x) * 0.75;
    colour = mix(colour, mix(vec3(0.70, 0.78, 0.82), vec3(0.22, 0.30, 0.35), dark), ruled(at.x, 30.0, 1.0));
    return shaft || head ? mix(vec3(0.12, 0.50, 0.62), vec3(0.35, 0.74, 0.85), dark) : colour;
}

// --- Light within the vessel ---

// Through a round wall from within, and on into the room.
vec3 leave_round(vec3 at, vec3 light, float index) {
    bool thrown_back;
    vec3 in_wall = bend(light, round_normal(at), index, indices.y, thrown_back);
    if (thrown_back) return room(at, light) * 0.5;
    vec3 outer = at + in_wall * farther(at, in_wall, radius);
    vec3 outside = bend(in_wall, round_normal(outer), indices.y, indices.x, thrown_back);
    return room(outer, outside) * (thrown_back ? 0.6 : 0.97);
}

vec3 within(vec3 from, vec3 light, bool wet, float liquid, bool filled) {
    const vec3 TINT = vec3(0.0016, 0.0005, 0.0003);
    vec3 clear = vec3(1.0);
    straight_in_liquid = wet;
    for (int piece = 0; piece < 6; piece++) {
        float index = wet ? liquid : indices.x;
        vec3 normal;
        float t_thing = hit_thing(from, light, normal);
        float t_surface = (level.y - from.y) / light.y;
        if (t_surface < TOUCHING) t_surface = NONE;
        float t_floor = light.y > 1e-5 ? (level.z - from.y) / light.y : NONE;
        float t_wall;
        if (wall == 0) {
            float side = ((light.x > 0.0 ? tank.x : -tank.x) - from.x) / light.x;
            float back = ((light.z > 0.0 ? tank.y : thickness) - from.z) / light.z;
            t_wall = min(side, back);
        } else {
            t_wall = farther(from, light, radius - thickness);
        }
        if (wall == 2) t_floor = NONE;
        float t = min(min(t_thing, t_surface), min(t_floor, t_wall));
        vec3 at = from + light * t;
        reached = at;
        if (wet && filled) clear *= exp(-TINT * t);
        if (t == t_surface) {
            bool thrown_back;
            light = bend(light, vec3(0.0, -1.0, 0.0), index, wet ? indices.x : liquid, thrown_back);
            wet = thrown_back ? wet : !wet;
            straight_in_liquid = false;
            from = at;
            continue;
        }
        if (t == t_thing) return clear * thing_colour(at, normal);
        if (t == t_floor) return clear * (wall == 0 ? back_colour(at.xzy) * 0.86 : room(at - light, light) * 0.9);
        // Over the rim, or back out by the front.
        if (at.y < level.x || (wall == 0 && t_wall == t && light.z < 0.0 && at.z < thickness + 0.1)) {
            return clear * room(at, light);
        }
        if (wall == 0) {
            float shade = abs(at.x) > tank.x - 0.1 ? 0.84 : 1.0;
            return clear * shade * back_colour(abs(at.x) > tank.x - 0.1 ? at.zyx : at);
        }
        return clear * leave_round(at, light, index);
    }
    return clear * vec3(0.5);
}

// Where the outer face is met; NONE where it is not, or beyond the vessel's edges.
float hit_front(vec3 from, vec3 light) {
    float t = wall == 0 ? -from.z / light.z : nearer(from, light, radius);
    if (t >= NONE || t < 0.0) return NONE;
    vec3 at = from + light * t;
    if (wall == 2) return t;
    bool beside = at.y < level.x || at.y > level.z || (wall == 0 && abs(at.x) > tank.x);
    return beside ? NONE : t;
}

vec3 trace(vec3 light, float liquid, bool filled) {
    straight_in_liquid = false;
    float t = hit_front(eye, light);
    if (t >= NONE) {
        vec3 normal;
        float t_thing = hit_thing(eye, light, normal);
        vec3 above = eye + light * t_thing;
        if (t_thing < NONE && above.y < level.x) return thing_colour(above, normal);
        float t_rim = (level.x - eye.y) / light.y;
        vec3 rim = eye + light * t_rim;
        bool over = wall == 0
            ? abs(rim.x) < tank.x && rim.z > 0.0 && rim.z < tank.y
            : wall == 1 && length(across(rim - centre())) < radius - thickness;
        bool down = light.y > 1e-4 && t_rim > 0.0;
        return over && down ? within(rim, light, false, liquid, filled) : room(eye, light);
    }
    vec3 outer = eye + light * t;
    bool thrown_back;
    vec3 normal = wall == 0 ? vec3(0.0, 0.0, -1.0) : round_normal(outer);
    vec3 in_wall = bend(light, normal, indices.x, indices.y, thrown_back);
    if (thrown_back) return room(outer, in_wall);
    float t_inner = wall == 0 ? thickness / in_wall.z : nearer(outer, in_wall, radius - thickness);
    if (t_inner >= NONE) {
        // Along the wall and out again.
        vec3 end = outer + in_wall * farther(outer, in_wall, radius);
        vec3 outside = bend(in_wall, round_normal(end), indices.y, indices.x, thrown_back);
        return room(end, outside) * 0.72;
    }
    vec3 inner = outer + in_wall * t_inner;
    bool wet = inner.y > level.y;
    vec3 inner_normal = wall == 0 ? normal : round_normal(inner);
    vec3 inside = bend(in_wall, inner_normal, indices.y, wet ? liquid : indices.x, thrown_back);
    if (thrown_back) return room(outer, reflect(light, normal)) * 0.8;
    vec3 colour = within(inner, inside, wet, liquid, filled);
    // The liquid's edge at the wall, and the wall's own edges, catch some light.
    float edge = filled ? 0.55 * (1.0 - smoothstep(0.0, 1.2, abs(inner.y - level.y))) : 0.0;
    float frame = wall == 0 ? max(abs(outer.x) - tank.x + 2.5, max(level.x + 2.5 - outer.y, outer.y - level.z + 2.5)) : level.x + 2.5 - outer.y;
    if (wall != 2) edge = max(edge, 0.6 * smoothstep(0.0, 0.8, frame));
    return mix(colour, mix(vec3(1.0), vec3(0.72, 0.86, 0.92), dark), edge);
}

vec3 ray_of(vec2 pixel) {
    return normalize(world_from_eye * vec3((pixel - lens.yz) / lens.x, 1.0));
}

void main() {
#ifdef PROBE
    vec2 pixel = probe.xy + floor(gl_FragCoord.xy) * probe.zw;
    trace(ray_of(pixel), indices.z, true);
    landed = uvec4(floatBitsToUint(reached), straight_in_liquid ? 1u : 0u);
#else
    vec2 pixel = vec2(gl_FragCoord.x, picture_height - gl_FragCoord.y) - 0.5;
    bool filled = gl_FragCoord.x < divider;
    float liquid = filled ? indices.z : indices.x;
    // Four rays a pixel: edges without steps.
    vec3 sum = vec3(0.0);
    sum += trace(ray_of(pixel + vec2(-0.125, -0.375)), liquid, filled);
    sum += trace(ray_of(pixel + vec2(0.375, -0.125)), liquid, filled);
    sum += trace(ray_of(pixel + vec2(0.125, 0.375)), liquid, filled);
    sum += trace(ray_of(pixel + vec2(-0.375, 0.125)), liquid, filled);
    shown = vec4(sum * 0.25, 1.0);
#endif
}
