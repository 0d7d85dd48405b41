#version 330 core
// A portrait studio: warm key from the upper left, cool fill, rim light, sky and floor.
// The lights stand around the camera, so that every view is lit for that view.
uniform mat4 world_from_camera;

in vec3 world_position;
in vec3 world_normal;
in vec4 surface; // roughness, flesh, wet, hair
in vec3 albedo;

out vec4 pixel;

const vec3 KEY_FROM = vec3(-0.52, 0.50, 0.69);  // in camera space, unit length
const vec3 FILL_FROM = vec3(0.80, 0.05, 0.60);
const vec3 RIM_FROM = vec3(0.66, 0.45, -0.60);
const vec3 CATCH_FROM = vec3(-0.20, 0.26, 0.945);
const vec3 KEY = vec3(1.00, 0.93, 0.84) * 0.86;
const vec3 FILL = vec3(0.72, 0.84, 1.00) * 0.22;
const vec3 RIM = vec3(0.80, 0.90, 1.00) * 0.75;
const vec3 SKY = vec3(0.86, 0.93, 1.00) * 0.34;
const vec3 FLOOR = vec3(1.00, 0.80, 0.68) * 0.20;

// Light that travels through flesh: red reaches farthest around the edge of a shadow.
const vec3 SCATTER = vec3(0.42, 0.16, 0.09);

vec3 lambert(float facing, vec3 wrap) {
    return max((facing + wrap) / ((1.0 + wrap) * (1.0 + wrap)), 0.0);
}

// Cook-Torrance with GGX, in a form without powers or divisions by the angles.
float gloss(vec3 normal, vec3 light, vec3 view, float roughness) {
    vec3 half_way = normalize(light + view);
    float a = roughness * roughness;
    float a2 = a * a;
    float cosine = max(dot(normal, half_way), 0.0);
    float tail = cosine * cosine * (a2 - 1.0) + 1.0;
    float grazing = max(dot(light, half_way), 0.3);
    return a2 / (4.0 * tail * tail * grazing * grazing * (roughness + 0.5));
}

vec3 srgb(vec3 linear) {
    vec3 s1 = sqrt(linear);
    vec3 s2 = sqrt(s1);
    vec3 s3 = sqrt(s2);
    return 0.662002687 * s1 + 0.684122060 * s2 - 0.323583601 * s3 - 0.0225411470 * linear;
}

void main() {
    mat3 turn = mat3(world_from_camera);
    vec3 view = normalize(world_from_camera[3].xyz - world_position);
    vec3 normal = normalize(gl_FrontFacing ? world_normal : -world_normal);
    float roughness = surface.x;
    float flesh = surface.y;
    float wet = surface.z;

    vec3 key = turn * KEY_FROM;
    vec3 fill = turn * FILL_FROM;
    vec3 rim = turn * RIM_FROM;
    float key_facing = dot(normal, key);
    vec3 wrap = SCATTER * flesh + 0.04;

    float up = dot(normal, turn[1]) * 0.5 + 0.5;
    vec3 light = mix(FLOOR, SKY, up);
    light += KEY * lambert(key_facing, wrap);
    light += FILL * lambert(dot(normal, fill), wrap);

    float edge = 1.0 - max(dot(normal, view), 0.0);
    float fresnel = edge * edge * edge;
    vec3 back = RIM * max(dot(normal, rim) + 0.25, 0.0) * fresnel;

    float mirror = 0.04 + 0.25 * fresnel * edge;
    vec3 shine = KEY * gloss(normal, key, view, roughness) * max(key_facing, 0.0);
    shine += FILL * gloss(normal, fill, view, roughness) * max(dot(normal, fill), 0.0);
    shine *= mirror;
    vec3 catch_light = turn * CATCH_FROM;
    shine += vec3(wet * 0.04 * gloss(normal, catch_light, view, max(roughness, 0.12)));

    vec3 colour = albedo * (light + back) + shine + back * 0.05;
    colour = colour * (1.0 + colour * 0.16) / (1.0 + colour * 0.36);
    pixel = vec4(srgb(colour), 1.0);
}
