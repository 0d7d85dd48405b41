#version 330 core
// The character, in world space (metres).
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 look;   // roughness, flesh, wet, hair
layout(location = 3) in vec4 colour; // linear RGB

uniform mat4 clip_from_world;

out vec3 world_position;
out vec3 world_normal;
out vec4 surface;
out vec3 albedo;

void main() {
    gl_Position = clip_from_world * vec4(position, 1.0);
    world_position = position;
    world_normal = normal;
    surface = look;
    albedo = colour.rgb;
}
