#version 330 core
// The character, lit pixel by pixel; or, in QUICK, as the vertices were.
out vec4 pixel; // blue first, as the window has it: so it is read back as it lies

#ifdef QUICK
in vec3 shown;

void main() {
    pixel = vec4(shown.bgr, 1.0);
}
#else
in vec3 towards_camera;
in vec3 camera_normal;
in vec2 sky;
in vec3 surface;
in vec3 albedo;
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
    pixel = vec4(lit(towards_camera, normal, sky, surface, albedo).bgr, 1.0);
}
#endif
