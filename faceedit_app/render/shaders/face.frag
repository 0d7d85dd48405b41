#version 330 core
// The character, lit pixel by pixel; or, in QUICK, as the vertices were.
out vec4 pixel; // blue first, as the window has it: so it is read back as it lies

#ifdef TEXTURED
struct Material {
    sampler2D base_color_texture;
};

uniform Material material; // pyrender's names
uniform float cutoff;

in vec2 uv;
in vec4 tint;

vec3 textured() {
    vec4 texel = texture(material.base_color_texture, uv) * tint;
    if (texel.a < cutoff) {
        discard;
    }
    return texel.rgb;
}
#endif

#ifdef HAIR
in vec3 strand;
in float around;
#include "strands.glsl"
#endif
#ifdef SHEER
in float cover; // how much it hides of what is behind it, 0..1
#endif

float opacity() {
#if defined(SHEER) && defined(HAIR)
    // Where hair begins, single strands show first.
    float thin = 0.55 * strands(around);
    return smoothstep(thin, thin + 0.45, cover);
#elif defined(SHEER)
    return cover;
#else
    return 1.0;
#endif
}

#if defined(QUICK) && defined(TEXTURED)
in vec3 light;
in vec3 added;

#include "light.glsl"

void main() {
    pixel = vec4(exposed(textured(), light, added).bgr, 1.0);
}
#elif defined(QUICK)
in vec3 shown;

void main() {
    pixel = vec4(shown.bgr, opacity());
}
#else
in vec3 towards_camera;
in vec3 camera_normal;
in vec2 sky;
in vec3 surface;
#ifndef TEXTURED
in vec3 albedo;
#endif

#include "light.glsl"

void main() {
    vec3 normal = normalize(camera_normal);
#ifndef FLESH
    normal = gl_FrontFacing ? normal : -normal;
#endif
#ifdef TEXTURED
    vec3 albedo = textured();
#endif
    vec2 above = sky;
#ifdef WET
    above.y *= gl_FrontFacing ? 1.0 : 0.3; // the backs of the teeth
#endif
    pixel = vec4(lit(towards_camera, normal, above, surface, albedo).bgr, opacity());
}
#endif
