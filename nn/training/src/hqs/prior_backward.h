#pragma once

#include <memory>
#include <optional>
#include <span>

#include "graph/graph_backward.h"
#include "hqs/prior.h"
#include "hqs/u_shaped_prior.h"

namespace hqslam::nn {

/// What the loss compares Z with.
struct LossTarget {
  const Tensor& truth;                        ///< tiles of PriorBackward::put_truth
  std::optional<RowSelection> restored_rows;  ///< rows that count as exact
  float share = 1.0F;                         ///< of this layer in the loss
};

/// What training needs of a prior beside `Prior::forward`.
class PriorBackward {
 public:
  /// The prior must outlive it.
  explicit PriorBackward(Prior& prior) : prior_(prior), graph_backward_(prior.graph()) {}
  virtual ~PriorBackward() = default;

  /// The prior's new parameters, which it has already.
  void take_parameters(std::span<const float> parameters) {
    const BeamParameters* beams = prior_.beams();
    if (beams == nullptr) {
      graph_backward_.set_parameters(parameters);
    } else {
      graph_backward_.set_parameters(beams->of_graph(parameters));
    }
  }
  /// For `backward` to work in; output() has the memory channels at least.
  virtual PriorState make_gradient() const { return prior_.make_state(); }
  /// All true ranges as tiles in the unit that the loss takes: range / range_scale_m.
  virtual void put_truth(const RangeImage& truth_m, float range_scale_m, Tensor& tiles) const;
  /// The loss of Z. Writes `share` times its gradient to gradient.z, or wherever `backward` takes
  /// it from. One thread. Here: the mean absolute error.
  virtual double loss(const PriorState& state, const LossTarget& target,
                      PriorState& gradient) const;
  /// In: gradient.z and the memory channels of gradient.output(). Out: gradient.input();
  /// d_parameters is added to. One thread.
  virtual void backward(const Candidates& candidates, const PriorState& state, PriorState& gradient,
                        std::span<float> d_parameters) = 0;

 protected:
  Prior& prior_;
  GraphBackward graph_backward_;
};

/// The backward pass of a prior of nn/hqs, or the prior itself if it implements PriorBackward.
/// Throws Error if there is none.
std::shared_ptr<PriorBackward> backward_of(Prior& prior);

/// Mean of |Z - truth| over all pixels, "no return" counting as range 0. Rows of the result that
/// get their measured ranges back count as exact (`restored_rows`; nothing: there are none). Writes
/// `share` times the gradient d loss / d Z (0 where the two are equal). Tiles.
double l1_loss(const Tensor& z, const Tensor& truth, TileSize tile,
               std::optional<RowSelection> restored_rows, float share, Tensor& d_z);

/// The gradient of select_row for some rows, `first_row` and what follows it: as many as d_scores
/// has. weights: what select_row left. d_z: d loss / d Z. Writes d loss / d scores (groups as
/// there, borders filled) and d loss / d H along the direct way through w_h. One thread.
void select_backward(const CandidatesOf& candidates, const Tensor& h, TileSize tile,
                     InstructionSet instruction_set, int first_row, const Tensor& weights,
                     const Tensor& d_z, Tensor& d_scores, Tensor& d_h);

}  // namespace hqslam::nn
