#version 330 core
// The character: world space (metres) to camera space.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 look;   // roughness, flesh, wet, light from above
#ifdef TEXTURED
layout(location = 3) in vec2 place;  // in the texture
layout(location = 4) in vec4 colour; // linear RGB and alpha
#else
layout(location = 3) in vec4 colour;
#endif

uniform mat4 clip_from_world;
uniform mat4 camera_from_world;

#ifdef HAIR
out vec3 strand;
out float around;
#include "strands.glsl"
#endif
#ifdef TEXTURED
out vec2 uv;
out vec4 tint;
#endif
#if defined(QUICK) && defined(TEXTURED)
out vec3 light;
out vec3 added;

#include "light.glsl"
#elif defined(QUICK)
out vec3 shown;

#include "light.glsl"
#else
out vec3 towards_camera;
out vec3 camera_normal;
out vec2 sky;     // how far the normal points up, -1..1; light that arrives from above
out vec3 surface; // roughness, flesh, wet
#ifndef TEXTURED
out vec3 albedo;
#endif
#endif
#ifdef SHEER
out float cover;
#endif
#ifdef WET
#include "hollows.glsl"
#endif
#ifdef HAIR
const vec3 COMB_TO = vec3(0.0, 0.616, -0.788);
const vec3 COMB_UP = vec3(0.0, 0.788, 0.616);
const vec3 COMB_CENTRE = vec3(0.0, 0.060, -0.055); // metres, inside the skull
#endif

void main() {
    gl_Position = clip_from_world * vec4(position, 1.0);
    mat3 turn = mat3(camera_from_world);
    vec3 view = -normalize((camera_from_world * vec4(position, 1.0)).xyz);
#ifdef HAIR
    // Hair is combed to the back of the head, along the surface.
    strand = turn * normalize(COMB_TO - normal * dot(COMB_TO, normal) + 1e-4);
    vec3 place_on_head = position - COMB_CENTRE;
    around = atan(place_on_head.x, dot(place_on_head, COMB_UP));
#endif
#ifdef TEXTURED
    uv = place;
    tint = colour;
#endif
#if defined(QUICK) && defined(TEXTURED)
    lights(view, turn * normal, vec2(normal.y, look.w), look.xyz, vec3(1.0), light, added);
#elif defined(QUICK)
    // While things move: from vertex to vertex there is too little difference to be seen.
    shown = lit(view, turn * normal, vec2(normal.y, look.w), look.xyz, colour.rgb);
#else
    towards_camera = view;
    camera_normal = turn * normal;
    sky = vec2(normal.y, look.w);
#ifdef WET
    sky.y *= look.z > 0.9 ? between_lids(position) : between_lips(position); // eyes are wettest
#endif
    surface = look.xyz;
#ifndef TEXTURED
    albedo = colour.rgb;
#endif
#endif
#ifdef SHEER
    cover = colour.a;
#endif
}
