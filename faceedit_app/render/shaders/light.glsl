// A portrait studio: warm key from the upper left, cool fill, rim light, sky and floor.
// All in camera space: the lights stand around the camera, so each view is lit for that view.
const vec3 KEY_FROM = vec3(-0.58, 0.50, 0.643);
const vec3 FILL_FROM = vec3(0.80, 0.05, 0.60);
const vec3 RIM_FROM = vec3(0.66, 0.45, -0.60);
// Half way from each light to a far camera; that it is near makes no visible difference.
const vec3 KEY_HALF = vec3(-0.320, 0.276, 0.906);
const vec3 FILL_HALF = vec3(0.447, 0.028, 0.894);
const vec2 CATCH_AT = vec2(-0.125, 0.12); // the catch light: a round lamp, by its mirror normal
const float CATCH_SIZE = 0.062;
const float KEY_GRAZING = 0.822; // squared cosine between light and half way
const float FILL_GRAZING = 0.80;

const vec3 KEY = vec3(1.00, 0.91, 0.80) * 1.40;
const vec3 FILL = vec3(0.70, 0.82, 1.00) * 0.17;
const vec3 RIM = vec3(0.80, 0.90, 1.00) * 1.10;
const vec3 SKY = vec3(0.92, 0.93, 1.00) * 0.26;
const vec3 FLOOR = vec3(1.00, 0.72, 0.58) * 0.18;

// Light that travels through flesh: red reaches farthest around the edge of a shadow.
const vec3 SCATTER = vec3(0.36, 0.20, 0.13);

// What is left of sky and floor where nothing arrives; among flesh, that has been through it.
const vec3 LEAST = vec3(0.36, 0.29, 0.26);
const vec3 LEAST_IN_FLESH = vec3(0.34, 0.15, 0.12);

vec3 lambert(float facing, vec3 wrap) {
    return max((facing + wrap) / ((1.0 + wrap) * (1.0 + wrap)), 0.0);
}

// Cook-Torrance with GGX, in a form without powers or roots.
float gloss(float cosine, float roughness, float grazing) {
    float a = roughness * roughness;
    float a2 = a * a;
    float tail = cosine * cosine * (a2 - 1.0) + 1.0;
    return a2 / (4.0 * tail * tail * grazing * (roughness + 0.5));
}

vec3 srgb(vec3 linear) {
    vec3 s1 = sqrt(linear);
    vec3 s2 = sqrt(s1);
    vec3 s3 = sqrt(s2);
    return 0.662002687 * s1 + 0.684122060 * s2 - 0.323583601 * s3 - 0.0225411470 * linear;
}

// The light that falls on a point, and what it sends back whatever its colour is. `sky`: how far
// the normal points up, -1..1, and light that arrives from above; `surface`: roughness, flesh, wet.
// Hair reads `strand`, `around` and `albedo` too.
void lights(vec3 view, vec3 normal, vec2 sky, vec3 surface, vec3 albedo,
            out vec3 light, out vec3 added) {
    float roughness = surface.x;
    float flesh = surface.y;
    // Shade on flesh is warm too: what light is left has come through it.
    vec3 arriving = sky.y + SCATTER * (flesh * sky.y * (1.0 - sky.y));

    float key_facing = dot(normal, KEY_FROM);
    float fill_facing = dot(normal, FILL_FROM);
    vec3 wrap = SCATTER * flesh + 0.04;
    float edge = 1.0 - clamp(dot(normal, view), 0.0, 1.0);
    float fresnel = edge * edge * edge;
    vec3 back = RIM * (max(dot(normal, RIM_FROM) + 0.25, 0.0) * fresnel);

#ifdef WET
    vec3 least = mix(LEAST, LEAST_IN_FLESH, flesh * (1.0 - sky.y));
#else
    const vec3 least = LEAST;
#endif
    light = mix(FLOOR, SKY, sky.x * 0.5 + 0.5) * (least + 0.7 * arriving);
    light += KEY * lambert(key_facing, wrap) * arriving;
    // In mouth and nostrils, neither of them arrives.
#ifdef WET
    float open = sky.y;
#else
    float open = min(4.0 * sky.y * sky.y, 1.0);
#endif
    back *= open;
    light += FILL * lambert(fill_facing, wrap) * open + back;

    float mirror = (0.04 + 0.25 * fresnel * edge) * sky.y;
#ifndef WET
    mirror *= open;
#endif
#ifdef HAIR
    // Two highlights across the strands (Kajiya and Kay; Marschner et al.): a narrow one in the
    // colour of the light and, behind it, a wide one in the hair's. Strands lie unevenly, which
    // breaks both up.
    float fine = strands(around);
    float along = dot(strand, KEY_HALF) / max(length(strand), 1e-3) + 0.22 * (fine - 0.5);
    float narrow = max(1.0 - (along + 0.10) * (along + 0.10), 0.0);
    float wide = max(1.0 - (along - 0.16) * (along - 0.16), 0.0);
    wide *= wide;
    wide *= wide;
    narrow *= narrow;
    narrow *= narrow;
    narrow *= narrow;
    narrow *= narrow;
    vec3 shine = KEY * (max(key_facing + 0.3, 0.0) * (0.55 + 0.9 * fine));
    // Where skin shows between the roots, hair shines no more than elsewhere.
    vec3 own = albedo * min(0.06 / max(albedo.r, 1e-3), 1.0);
    shine *= narrow * narrow * 0.035 + wide * 0.8 * own;
    light *= 0.80 + 0.40 * fine;
#else
    vec3 shine = KEY * (gloss(max(dot(normal, KEY_HALF), 0.0), roughness, KEY_GRAZING)
                        * max(key_facing, 0.0));
    shine += FILL * (gloss(max(dot(normal, FILL_HALF), 0.0), roughness, FILL_GRAZING)
                     * max(fill_facing, 0.0));
    shine *= mirror;
#endif
#ifdef THIN
    shine = vec3(0.0); // a lash is too thin to show a highlight
#endif
#ifdef WET
    float off = length(normal.xy - CATCH_AT);
    float inside = clamp((CATCH_SIZE - off) / (1.2 * roughness * roughness) + 0.5, 0.0, 1.0);
    shine += vec3(surface.z * 1.3 * inside);
#endif

    added = shine + back * 0.05;
}

// sRGB of what a point of some colour sends back.
vec3 exposed(vec3 albedo, vec3 light, vec3 added) {
    vec3 colour = albedo * light + added;
    colour = colour * (1.0 + colour * 0.16) / (1.0 + colour * 0.36);
    return srgb(colour);
}

vec3 lit(vec3 view, vec3 normal, vec2 sky, vec3 surface, vec3 albedo) {
    vec3 light;
    vec3 added;
    lights(view, normal, sky, surface, albedo, light, added);
    return exposed(albedo, light, added);
}
