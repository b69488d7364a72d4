#include "attention_kernels.h"

#include "kernels/vector_math_inl.h"

// The element-wise part of transformers and the attention within one window, for vectors of
// kVectorFloats floats. layers/layers.h has the formulas. Compiled once per instruction set, as
// nn's row_kernels.cpp.
namespace hqslam::nn::kernels {
namespace {

/// P(X < v) for a standard normal X = (1 + erf(v / sqrt 2)) / 2, absolute error below 1e-7; erf by
/// Abramowitz & Stegun, Handbook of Mathematical Functions, 7.1.26. `density`: e^(-v^2 / 2).
inline Vector normal_distribution(Vector v, Vector density) {
  const Vector t = 1.0F / (1.0F + 0.3275911F * 0.707106781F * magnitude(v));
  Vector sum = t * 1.061405429F - 1.453152027F;
  sum = sum * t + 1.421413741F;
  sum = sum * t - 0.284496736F;
  sum = sum * t + 0.254829592F;
  const Vector tail = 0.5F * sum * t * density;
  return v > 0.0F ? 1.0F - tail : tail;
}

void gelu(const GeluRow& row) {
  for (int x = 0; x < row.columns; x += kVectorFloats) {
    const Vector v = load(row.input + x);
    const Vector density = exponential(-0.5F * v * v);
    const Vector share = normal_distribution(v, density);
    if (row.d_output == nullptr) {
      store(row.output + x, v * share);
    } else {
      const Vector slope = share + 0.398942280F * v * density;
      store(row.output + x, load(row.output + x) + slope * load(row.d_output + x));
    }
  }
}

constexpr int kWindowVectors = kWindowPixels / kVectorFloats;
static_assert(kWindowVectors * kVectorFloats == kWindowPixels);

/// result[r][:] = sum_t coefficient[r result_step + t term_step] rows[t][:] for kResults r, each
/// row of 16.
template <int kResults>
inline void add_rows(int terms, const float* coefficient, int result_step, int term_step,
                     const float* rows, float* result) {
  Vector sum[kResults][kWindowVectors] = {};
  for (std::int64_t t = 0; t < terms; ++t) {
    Vector in[kWindowVectors];
#pragma GCC unroll 4
    for (int p = 0; p < kWindowVectors; ++p)
      in[p] = load(rows + t * kWindowPixels + p * kVectorFloats);
#pragma GCC unroll 8
    for (int r = 0; r < kResults; ++r) {
      const float factor = coefficient[r * result_step + t * term_step];
#pragma GCC unroll 4
      for (int p = 0; p < kWindowVectors; ++p) sum[r][p] += factor * in[p];
    }
  }
#pragma GCC unroll 8
  for (int r = 0; r < kResults; ++r) {
#pragma GCC unroll 4
    for (int p = 0; p < kWindowVectors; ++p) {
      store(result + r * kWindowPixels + p * kVectorFloats, sum[r][p]);
    }
  }
}

/// The sums for `results` r, a multiple of 4.
void multiply(int results, int terms, const float* coefficient, int result_step, int term_step,
              const float* rows, float* result) {
  constexpr int kResults = kWindowVectors > 2 ? 2 : 4;
  for (int r = 0; r < results; r += kResults) {
    add_rows<kResults>(terms, coefficient + r * result_step, result_step, term_step, rows,
                       result + r * kWindowPixels);
  }
}

/// Queries are the lanes, so that the softmax over keys needs no sums over lanes.
void attend(const AttentionWindow& window) {
  constexpr int kN = kWindowPixels;
  float* p = window.probabilities;
  multiply(kN, window.depth, window.keys, 1, kN, window.queries, p);
  for (int x = 0; x < kN; x += kVectorFloats) {
    Vector largest = load(p + x) + load(window.bias + x);
    for (int key = 0; key < kN; ++key) {
      const Vector score = load(p + key * kN + x) + load(window.bias + key * kN + x);
      store(p + key * kN + x, score);
      largest = larger(largest, score);
    }
    Vector sum{};
    for (int key = 0; key < kN; ++key) {
      const Vector e = exponential(load(p + key * kN + x) - largest);
      store(p + key * kN + x, e);
      sum += e;
    }
    const Vector scale = 1.0F / sum;
    for (int key = 0; key < kN; ++key) store(p + key * kN + x, load(p + key * kN + x) * scale);
  }
  multiply(window.depth, kN, window.values, kN, 1, p, window.output);
}

inline void transpose(const float* from, float* to) {
  for (int i = 0; i < kWindowPixels; ++i) {
    for (int j = 0; j < kWindowPixels; ++j) to[j * kWindowPixels + i] = from[i * kWindowPixels + j];
  }
}

/// With scores s, probabilities p and o = sum p v: d_v = sum d_o p, d_p = d_o v,
/// d_s = p (d_p - sum_keys p d_p), d_q = sum d_s k, d_k = sum d_s q.
void attend_backward(const AttentionGradient& g) {
  constexpr int kN = kWindowPixels;
  const AttentionWindow& w = g.forward;
  alignas(64) float transposed[kN * kN];
  alignas(64) float d_scores[kN * kN];
  transpose(w.probabilities, transposed);
  multiply(w.depth, kN, g.d_output, kN, 1, transposed, g.d_values);
  multiply(kN, w.depth, w.values, 1, kN, g.d_output, d_scores);
  for (int x = 0; x < kN; x += kVectorFloats) {
    Vector sum{};
    for (int key = 0; key < kN; ++key) {
      sum += load(w.probabilities + key * kN + x) * load(d_scores + key * kN + x);
    }
    for (int key = 0; key < kN; ++key) {
      const Vector d = load(w.probabilities + key * kN + x) * (load(d_scores + key * kN + x) - sum);
      store(d_scores + key * kN + x, d);
      store(g.d_bias + key * kN + x, load(g.d_bias + key * kN + x) + d);
    }
  }
  multiply(w.depth, kN, w.keys, kN, 1, d_scores, g.d_queries);
  transpose(d_scores, transposed);
  multiply(w.depth, kN, w.queries, kN, 1, transposed, g.d_keys);
}

}  // namespace

const AttentionKernels HQSLAM_KERNELS{gelu, attend, attend_backward};

}  // namespace hqslam::nn::kernels
