#version 330 core
// A lit wall: brightest behind the head, darker towards the corners and the floor.
uniform vec3 background; // sRGB

in vec2 place;

out vec4 pixel; // blue first

void main() {
    vec2 away = place - vec2(0.0, -0.15);
    float light = 1.22 - 0.24 * dot(away, away);
    // Dither by half a step, against bands in the dark.
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    pixel = vec4(background.bgr * max(light, 0.55) + (noise - 0.5) / 255.0, 1.0);
}
