// 0..1, uneven from strand to strand: noise of two sizes over the angle around the head.
float strands(float angle) {
    vec2 at = angle * vec2(46.0, 121.0) + 600.0;
    vec2 cell = floor(at);
    vec2 low = fract(cell * fract(cell * 0.1031 + 0.31));
    vec2 high = fract((cell + 1.0) * fract((cell + 1.0) * 0.1031 + 0.31));
    return dot(mix(low, high, at - cell), vec2(0.55, 0.45));
}
