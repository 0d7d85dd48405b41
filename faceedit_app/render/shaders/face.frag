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
    pixel = vec4(shown.bgr, 1.0);
}
#else
in vec3 towards_camera;
in vec3 camera_normal;
in vec2 sky;
in vec3 surface;
#ifndef TEXTURED
in vec3 albedo;
#endif
#ifdef HAIR
in vec3 strand;
in float around;
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
    pixel = vec4(lit(towards_camera, normal, sky, surface, albedo).bgr, 1.0);
}
#endif
