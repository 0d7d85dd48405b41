#version 330 core
// One triangle that covers the view, behind everything.
layout(location = 0) in vec3 position; // in clip space, y downwards as in the image

out vec2 place; // -1..1

void main() {
    place = position.xy;
    gl_Position = vec4(position, 1.0);
}
