// A Potts field by mean-field iteration, and flooding by ordered queues.
//
// Mean field (Parisi 1988; for pictures Zhang 1992): q_i(k) ~ exp(e_i(k) + sum over neighbours j of b_ij q_j(k)). Four
// classes of pixels (even and odd x and y) hold no two neighbours, so that each class is renewed at once, in place, and
// the answer does not depend on threads. Pixels that are sure and stand among their like are left out: they are most.
#include "reassembly/label_field.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"

namespace gonio::reassembly {
namespace {

constexpr int field_rounds = 4, flood_levels = 1024;
constexpr float pull_straight = 0.7f, pull_diagonal = 0.5f, pull_all = 4 * (pull_straight + pull_diagonal);

struct Neighbour {
  int dx, dy;
  float pull;
};
constexpr std::array<Neighbour, 8> neighbours{{{1, 0, pull_straight},
                                               {-1, 0, pull_straight},
                                               {0, 1, pull_straight},
                                               {0, -1, pull_straight},
                                               {1, 1, pull_diagonal},
                                               {-1, 1, pull_diagonal},
                                               {1, -1, pull_diagonal},
                                               {-1, -1, pull_diagonal}}};

void softmax(const float* log, float* share, int labels) {
  const float most = *std::max_element(log, log + labels);
  float sum = 0;
  for (int k = 0; k < labels; ++k) sum += share[k] = log[k] < most - 11 ? 0 : std::exp(log[k] - most);
  for (int k = 0; k < labels; ++k) share[k] /= sum;
}

class Field {
 public:
  Field(Evidence& evidence, const std::vector<std::int32_t>& fixed)
      : evidence_(evidence),
        fixed_(fixed),
        labels_(evidence.labels),
        share_(evidence.log.size()),
        best_(evidence.pixels()),
        busy_(evidence.pixels()) {}

  void run() {
    start();
    for (int round = 0; round < field_rounds; ++round)
      for (int phase = 0; phase < 4; ++phase) renew(phase);
    finish();
  }

 private:
  template <class Body>
  void rows(int first, int step, const Body& body) {
    const auto count = static_cast<std::size_t>(std::max(0, (evidence_.height - first + step - 1) / step));
    parallel_for(0, count, [&](std::size_t row) { body(first + step * static_cast<int>(row)); });
  }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(evidence_.width) + static_cast<std::size_t>(x);
  }
  float* share(std::size_t pixel) { return share_.data() + pixel * static_cast<std::size_t>(labels_); }
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < evidence_.width && y < evidence_.height; }

  void start() {
    rows(0, 1, [&](int y) {
      for (int x = 0; x < evidence_.width; ++x) {
        const std::size_t i = at(x, y);
        if (!fixed_.empty() && fixed_[i] >= 0) {
          std::fill(evidence_.of(i), evidence_.of(i) + labels_, Evidence::least - pull_all);
          evidence_.of(i)[fixed_[i]] = 0;
        }
        softmax(evidence_.of(i), share(i), labels_);
        best_[i] = evidence_.best(i);
      }
    });
    rows(0, 1, [&](int y) {
      for (int x = 0; x < evidence_.width; ++x) busy_[at(x, y)] = is_busy(x, y) ? 1 : 0;
    });
  }

  bool is_busy(int x, int y) {
    const std::size_t i = at(x, y);
    if (!fixed_.empty() && fixed_[i] >= 0) return false;
    if (share(i)[best_[i]] < 0.99f) return true;
    return std::any_of(neighbours.begin(), neighbours.end(), [&](const Neighbour& n) {
      return inside(x + n.dx, y + n.dy) && best_[at(x + n.dx, y + n.dy)] != best_[i];
    });
  }

  void marginal(int x, int y, float* log) {
    const std::size_t i = at(x, y);
    std::copy(evidence_.of(i), evidence_.of(i) + labels_, log);
    const bool amid = x > 0 && y > 0 && x + 1 < evidence_.width && y + 1 < evidence_.height;
    for (const Neighbour& n : neighbours) {
      if (!amid && !inside(x + n.dx, y + n.dy)) continue;
      const float* q = share(at(x + n.dx, y + n.dy));
      for (int k = 0; k < labels_; ++k) log[k] += n.pull * q[k];
    }
  }

  void renew(int phase) {
    rows(phase / 2, 2, [&](int y) {
      std::vector<float> log(static_cast<std::size_t>(labels_));
      for (int x = phase % 2; x < evidence_.width; x += 2) {
        if (busy_[at(x, y)] != 1) continue;
        float* q = share(at(x, y));
        marginal(x, y, log.data());
        const std::int32_t most = best_[at(x, y)];
        const float before = q[most];
        softmax(log.data(), q, labels_);
        if (std::abs(q[most] - before) < 0.002f) busy_[at(x, y)] = 2;  // settled
      }
    });
  }

  // The evidence becomes the marginals.
  void finish() {
    rows(0, 1, [&](int y) {
      std::vector<float> log(static_cast<std::size_t>(labels_));
      for (int x = 0; x < evidence_.width; ++x) {
        const std::size_t i = at(x, y);
        float* out = evidence_.of(i);
        if (busy_[i] != 0) {
          marginal(x, y, log.data());
          const float most = *std::max_element(log.begin(), log.end());
          for (int k = 0; k < labels_; ++k) out[k] = log[static_cast<std::size_t>(k)] - most;
        } else {
          for (int k = 0; k < labels_; ++k)
            if (k != best_[i]) out[k] -= pull_all;
        }
      }
    });
  }

  Evidence& evidence_;
  const std::vector<std::int32_t>& fixed_;
  int labels_;
  std::vector<float> share_;
  std::vector<std::int32_t> best_;
  std::vector<std::uint8_t> busy_;  // 0: sure among its like, 1: is renewed, 2: settled
};

}  // namespace

void smooth(Evidence& evidence, const std::vector<std::int32_t>& fixed) {
  Field(evidence, fixed).run();
}

std::vector<std::uint16_t> flood(int width, int height, std::vector<std::int32_t>& labels,
                                 const std::function<float(std::size_t, std::size_t, std::int32_t)>& cost) {
  struct Step {
    std::uint32_t to = 0;
    std::int32_t label = 0;
    std::uint16_t length = 0;
  };
  std::vector<std::vector<Step>> levels(flood_levels);  // first in, first out: plateaus are shared fairly (Meyer)
  std::vector<std::uint16_t> length(labels.size(), 0);
  const auto row = static_cast<std::size_t>(width);
  std::size_t level = 0;
  const auto spread_from = [&](std::size_t i) {
    const std::size_t x = i % row, y = i / row;
    const auto offer = [&](std::size_t to) {
      if (labels[to] != unlabelled) return;
      const float high = std::clamp(cost(i, to, labels[i]), 0.0f, 1.0f) * (flood_levels - 1);
      const auto next = static_cast<std::uint16_t>(std::min(65535, length[i] + 1));
      levels[std::max(level, static_cast<std::size_t>(high))].push_back(
          {static_cast<std::uint32_t>(to), labels[i], next});
    };
    if (x > 0) offer(i - 1);
    if (x + 1 < row) offer(i + 1);
    if (y > 0) offer(i - row);
    if (y + 1 < static_cast<std::size_t>(height)) offer(i + row);
  };
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (labels[i] != unlabelled) spread_from(i);
  for (; level < levels.size(); ++level)
    for (std::size_t next = 0; next < levels[level].size(); ++next) {
      const Step step = levels[level][next];
      if (labels[step.to] != unlabelled) continue;
      labels[step.to] = step.label;
      length[step.to] = step.length;
      spread_from(step.to);
    }
  return length;
}

}  // namespace gonio::reassembly
