// Random numbers: a padded, Owen-scrambled Sobol sequence whose points are dealt out along the Z curve
// of the picture. Samples of a pixel are stratified, and so are those of every square block of
// pixels: what is left of the noise is high-frequency, which eyes and filters average away.
//   Ahmed and Wonka, "Screen-space blue-noise diffusion of Monte Carlo sampling error via
//   hierarchical ordering of pixels", ACM TOG 39(6), 2020;
//   Burley, "Practical hash-based Owen scrambling", JCGT 9(4), 2020.

// Which point of the sequence; `salt` sets one bounce apart from the next.
struct Key {
  uint point;  // position on the curve, bits reversed
  uint salt;
};

float unit_float(uint bits) { return float(bits >> 8) * (1.0 / 16777216.0); }

// Flips every bit depending on those below it: on reversed bits, Owen's nested permutation.
uint permute(uint x, uint seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// Second dimension of Sobol's sequence from the first: Pascal's triangle modulo 2.
uint second_dimension(uint x) {
  x ^= x << 16;
  x ^= (x & 0x00ff00ffu) << 8;
  x ^= (x & 0x0f0f0f0fu) << 4;
  x ^= (x & 0x33333333u) << 2;
  x ^= (x & 0x55555555u) << 1;
  return x;
}

// In [0, 1).
float random(Key key, uint dimension) {
  return unit_float(permute(key.point, hash_combine(key.salt, dimension)));
}
vec2 random2(Key key, uint dimension) {
  uint seed = hash_combine(key.salt, dimension);
  uint x = permute(key.point, seed);
  uint y = second_dimension(x) ^ (seed * 0x9e3779b9u);
  return vec2(unit_float(x), unit_float(y));
}

Key branch(Key key, uint way) { return Key(key.point, hash_combine(key.salt, way)); }

uint spread_bits(uint x) {
  x = (x | (x << 8)) & 0x00ff00ffu;
  x = (x | (x << 4)) & 0x0f0f0f0fu;
  x = (x | (x << 2)) & 0x33333333u;
  return (x | (x << 1)) & 0x55555555u;
}
Key sample_key(uvec2 pixel, uint sample_index) {
  uint place = spread_bits(pixel.x & 0xffffu) | (spread_bits(pixel.y & 0xffffu) << 1);
  uint point = (place << frame.sample_bits) + sample_index;
  return Key(bitfieldReverse(point), hash(frame.seed));
}
