// Shade that follows lids and lips: on the eyeballs, and on what is in the mouth. In world space,
// in metres; what is known about the face comes with each picture (hollows.py).
uniform mat4 lids; // columns: middle of the upper and lower lid, left eye first; w: 1 if known
uniform mat4 lips; // columns: middle of the upper and lower lip, left and right corner
uniform mat3 head; // how it is turned: columns to its left, up and forward

const float EYE = 0.0145; // half the width of an eye

// The share of the light that arrives on an eyeball: little close under the upper lid.
float between_lids(vec3 place) {
    vec3 side = head[0];
    vec3 up = head[1];
    bool left = dot(place - 0.5 * (lids[0].xyz + lids[2].xyz), side) > 0.0;
    vec4 upper = left ? lids[0] : lids[2];
    vec4 lower = left ? lids[1] : lids[3];
    float gap = max(dot(upper.xyz - lower.xyz, up), 0.0);
    float aside = dot(place - upper.xyz, side) / EYE;
    float narrower = gap * aside * aside; // the lids meet in the corners
    float below = dot(upper.xyz - place, up) - 0.75 * narrower;
    float above = dot(place - lower.xyz, up) - 0.25 * narrower;
    float shade = mix(0.22, 1.0, smoothstep(-0.001, 0.0045, below));
    shade *= mix(0.75, 1.0, smoothstep(-0.0005, 0.0016, above));
    return mix(1.0, shade, upper.w * lower.w);
}

// The share of the light that arrives behind the lips: the less, the less they are open there, and
// the deeper it lies.
float between_lips(vec3 place) {
    vec3 side = head[0];
    vec3 up = head[1];
    vec3 middle = 0.25 * (lips[0] + lips[1] + lips[2] + lips[3]).xyz;
    float width = max(dot(lips[2].xyz - lips[3].xyz, side), 0.01);
    float gap = max(dot(lips[0].xyz - lips[1].xyz, up), 0.0);
    float aside = 2.0 * dot(place - middle, side) / width;
    float open = gap * gap / (gap + 0.004) * clamp(1.0 - aside * aside, 0.1, 1.0) + 0.0015;
    float deep = max(dot(middle - place, head[2]) - 0.007, 0.0);
    float light = open / (open + 0.29 * deep);
    light *= mix(0.85, 1.0, smoothstep(-0.002, 0.003, dot(lips[0].xyz - place, up)));
    // Through slits beside lips that meet in the middle, hardly any arrives.
    light *= mix(0.2, 1.0, smoothstep(0.001, 0.007, gap));
    // What lies as high as the eyes is no part of the mouth.
    float outside = smoothstep(0.8, 1.0, dot(place - middle, up) / width);
    return mix(1.0, light, lips[0].w * lips[2].w * (1.0 - outside));
}
