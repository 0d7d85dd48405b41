#version 330 core
// One triangle that covers the view, behind everything.
out vec2 place; // -1..1, y downwards as in the image

void main() {
    place = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    gl_Position = vec4(place, 1.0, 1.0);
}
