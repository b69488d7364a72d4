'use strict';
// What the graphics card runs for cloud.js: points, an occupancy grid, shading, depths and lines. The
// depth buffer holds 1 - near / distance.

const kPointVertices = `#version 300 es
in uint point;                // x, y, z in steps from the block's corner, and its confidence
in float bright;
uniform mat4 toClip;
uniform vec3 corner;
uniform float step, side, least;  // metres of a step; pixels of a point 1 m away, and at least
uniform vec2 heights;
uniform int by;               // height, confidence, brightness
uniform vec3 palette[5];
flat out vec3 colour;
void main() {
  vec3 place = corner + (vec3(point & 511u, point >> 9 & 511u, point >> 18 & 511u) + .5) * step;
  gl_Position = toClip * vec4(place, 1);
  gl_PointSize = clamp(side / gl_Position.w, least, 16.);
  float height = (place.z - heights.x) / (heights.y - heights.x);
  float share = 4. * clamp(by == 2 ? bright : by == 1 ? float(point >> 27) / 31. : height, 0., 1.);
  int stop = min(int(share), 3);
  colour = mix(palette[stop], palette[stop + 1], share - float(stop));
}`;
const kPointPixels = `#version 300 es
precision mediump float;
flat in vec3 colour;
out vec4 pixel;
void main() {
  vec2 off = 2. * gl_PointCoord - 1.;
  if (dot(off, off) > 1.5) discard;  // rounder where points are large
  pixel = vec4(colour, 1);
}`;

// The rectangle of an occupancy grid, whose pixels hold 0 unknown, 1 free, 2 occupied.
const kGridVertices = `#version 300 es
uniform mat4 toClip;
uniform vec3 corner;
uniform vec2 size;
out vec2 place;               // 0 to 1, from the lower left
void main() {
  place = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = toClip * vec4(corner + vec3(place * size, 0), 1);
}`;
const kGridPixels = `#version 300 es
precision highp float;
uniform highp usampler2D cells;
in vec2 place;
out vec4 pixel;
void main() {
  uint cell = texelFetch(cells, ivec2(vec2(place.x, 1. - place.y) * vec2(textureSize(cells, 0))), 0).r;
  pixel = vec4(cell == 0u ? vec3(.17, .19, .22) : cell == 1u ? vec3(.46, .49, .54) : vec3(0), 1);
}`;

// One triangle that covers the canvas.
const kWholeCanvas = `#version 300 es
void main() { gl_Position = vec4(4 * (gl_VertexID & 1) - 1, 2 * (gl_VertexID & 2) - 1, 0, 1); }`;
// Eye-dome lighting (Boucheny 2009): a pixel is the darker, the nearer the pixels beside it are, as
// factors of its distance. The depth buffer holds 1 - near / distance.
const kShadedPixels = `#version 300 es
precision highp float;
uniform highp sampler2D depths;
uniform sampler2D colours;
uniform int reach;
out vec4 pixel;
const ivec2 kBeside[4] = ivec2[](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));
float nearness(ivec2 at) { return 1. - texelFetch(depths, at, 0).r; }
void main() {
  ivec2 at = clamp(ivec2(gl_FragCoord.xy), ivec2(reach), textureSize(depths, 0) - 1 - reach);
  vec3 colour = texelFetch(colours, at, 0).rgb;
  float own = nearness(at), behind = 0.;
  if (own > 0.) {
    for (int i = 0; i < 4; ++i) {
      behind += clamp(nearness(at + reach * kBeside[i]) / own - 1., 0., .07);
    }
  }
  pixel = vec4(colour * exp(-16. * behind), 1);
}`;

// The depth of every pixel, in 24 bits: what is below the pointer is read from it.
const kDepthPixels = `#version 300 es
precision highp float;
uniform highp sampler2D depths;
out vec4 pixel;
void main() {
  uint bits = uint(texelFetch(depths, ivec2(gl_FragCoord.xy), 0).r * 16777215.);
  pixel = vec4(bits >> 16, bits >> 8 & 255u, bits & 255u, 255) / 255.;
}`;

// A stretch of a line as a strip of two triangles, as wide everywhere on the canvas.
const kLineVertices = `#version 300 es
in vec3 from, to;
uniform mat4 toClip;
uniform vec3 shift;
uniform vec2 pixel;           // of the canvas, whose sides are 2
uniform float width, near;
void main() {
  vec4 a = toClip * vec4(from + shift, 1), b = toClip * vec4(to + shift, 1);
  if (a.w < near && b.w > near) a = mix(a, b, (near - a.w) / (b.w - a.w));
  if (b.w < near && a.w > near) b = mix(b, a, (near - b.w) / (a.w - b.w));
  vec2 along = normalize((b.xy / b.w - a.xy / a.w) / pixel);
  vec2 across = vec2(-along.y, along.x) * (gl_VertexID % 2 == 0 ? 1. : -1.);
  gl_Position = gl_VertexID < 2 ? a : b;
  gl_Position.xy += (across + (gl_VertexID < 2 ? -along : along)) * .5 * width * pixel * gl_Position.w;
  gl_Position.z = 0.;
}`;
const kLinePixels = `#version 300 es
precision mediump float;
uniform vec3 colour;
out vec4 pixel;
void main() { pixel = vec4(colour, 1); }`;
