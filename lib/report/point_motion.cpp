// See point_motion.h.
#include "report/point_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "report/colour_map.h"
#include "report/number_text.h"
#include "report/page.h"

namespace gonio::report {
namespace {

using Vector = std::array<double, 3>;
using Matrix = std::array<double, 9>;

constexpr double width = 560, height = 420, margin = 24;
constexpr int steps = 4094, nowhere = 4095;
constexpr int colours = 11;

Vector at(const std::vector<float>& xyz, std::size_t i) {
  return {xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]};
}
bool there(const Vector& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}
double distance(const Vector& a, const Vector& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}
Vector turned(const Matrix& m, const Vector& v) {
  Vector out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2];
  return out;
}
Matrix product(const Matrix& a, const Matrix& b) {
  Matrix out{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) out[3 * i + j] += a[3 * i + k] * b[3 * k + j];
  return out;
}

// About the true points of all frames: the cube of the codes and the sphere of the picture.
struct Box {
  Vector low, middle;
  double side = 0, radius = 0;
};
Box box_of(const PointMotion& m) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Vector low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
  for (std::size_t i = 0; i < m.truth.size(); ++i)
    if (std::isfinite(m.truth[i])) {
      low[i % 3] = std::min<double>(low[i % 3], m.truth[i]);
      high[i % 3] = std::max<double>(high[i % 3], m.truth[i]);
    }
  Box box;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(low[i] <= high[i])) low[i] = high[i] = 0;
    box.middle[i] = 0.5 * (low[i] + high[i]);
    box.side = std::max(box.side, 2 * (high[i] - low[i]));
  }
  if (!(box.side > 0)) box.side = 1;
  for (std::size_t i = 0; i < 3; ++i) box.low[i] = box.middle[i] - 0.5 * box.side;
  for (std::size_t i = 0; i < m.truth.size() / 3; ++i)
    if (const double d = distance(at(m.truth, i), box.middle); std::isfinite(d)) box.radius = std::max(box.radius, d);
  if (!(box.radius > 0)) box.radius = 1;
  return box;
}

double full_distance(const PointMotion& m) {
  double full = m.full;
  for (std::size_t i = 0; m.full <= 0 && i < m.points * m.frames.size(); ++i)
    if (const double d = distance(at(m.truth, i), at(m.found, i)); std::isfinite(d)) full = std::max(full, d);
  return full > 0 ? full : 1;
}

std::string codes_of(const PointMotion& m, const Box& box) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(4 * m.truth.size());
  const std::size_t one = 3 * m.points;
  for (std::size_t f = 0; f < m.frames.size(); ++f)
    for (const auto* set : {&m.truth, &m.found})
      for (std::size_t i = f * one; i < (f + 1) * one; ++i) {
        const double v = ((*set)[i] - box.low[i % 3]) / box.side * steps;
        const int code = std::isfinite(v) ? static_cast<int>(std::lround(std::clamp<double>(v, 0, steps))) : nowhere;
        text += {digits[code >> 6], digits[code & 63]};
      }
  return text;
}

// One frame as a drawing, as the script draws it.
std::string still(const PointMotion& m, const Box& box, double full) {
  const std::size_t frame = m.frames.size() / 2;
  const double scale = (0.5 * height - margin) / box.radius;
  const auto seen = [&](const std::vector<float>& set, std::size_t p) {
    Vector v = at(set, frame * m.points + p);
    for (std::size_t i = 0; i < 3; ++i) v[i] -= box.middle[i];
    v = turned(m.turn, v);
    return Vector{0.5 * width + scale * v[0], 0.5 * height - scale * v[1], v[2]};
  };
  std::string links, lines, truth, found;
  for (const auto& [a, b] : m.links) {
    const Vector u = seen(m.truth, static_cast<std::size_t>(a)), v = seen(m.truth, static_cast<std::size_t>(b));
    if (there(u) && there(v)) links += format("M%.1f %.1fL%.1f %.1f", u[0], u[1], v[0], v[1]);
  }
  for (std::size_t p = 0; p < m.points; ++p) {
    const Vector u = seen(m.truth, p), v = seen(m.found, p);
    if (there(u)) truth += format("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\"/>", u[0], u[1]);
    if (!there(v)) continue;
    const double d = distance(at(m.truth, frame * m.points + p), at(m.found, frame * m.points + p));
    const std::string colour = there(u) ? hex(magnitude_colour(d / full)) : "none";
    if (there(u))
      lines += format("<path d=\"M%.1f %.1fL%.1f %.1f\" stroke=\"", u[0], u[1], v[0], v[1]) + colour + "\"/>";
    found += format("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" fill=\"", v[0], v[1]) + colour + "\"/>";
  }
  return format("<svg viewBox=\"0 0 %.0f %.0f\" role=\"img\" aria-label=\"", width, height) + escape(m.name) +
         "\"><path class=\"grid\" d=\"" + links + "\"/>" + lines + "<g class=\"truth\">" + truth + "</g><g>" + found +
         "</g></svg>";
}

// Eigenvectors of a symmetric matrix as rows, the largest eigenvalue first: Jacobi's rotations.
Matrix axes_of(Matrix a) {
  Matrix rows{1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (int sweep = 0; sweep < 30; ++sweep)
    for (const auto& [p, q] : {std::pair<std::size_t, std::size_t>{0, 1}, {0, 2}, {1, 2}}) {
      const double angle = 0.5 * std::atan2(2 * a[3 * p + q], a[3 * p + p] - a[3 * q + q]);
      Matrix turn{1, 0, 0, 0, 1, 0, 0, 0, 1};
      turn[3 * p + p] = turn[3 * q + q] = std::cos(angle);
      turn[3 * p + q] = std::sin(angle), turn[3 * q + p] = -std::sin(angle);
      Matrix back = turn;
      std::swap(back[1], back[3]), std::swap(back[2], back[6]), std::swap(back[5], back[7]);
      a = product(product(turn, a), back);
      rows = product(turn, rows);
    }
  std::array<std::size_t, 3> order{0, 1, 2};
  std::ranges::stable_sort(order, [&](std::size_t i, std::size_t j) { return a[4 * i] > a[4 * j]; });
  Matrix sorted{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double* row = &rows[3 * order[i]];
    const double* largest =
        std::max_element(row, row + 3, [](double u, double v) { return std::abs(u) < std::abs(v); });
    for (std::size_t j = 0; j < 3; ++j) sorted[3 * i + j] = *largest < 0 ? -row[j] : row[j];
  }
  return sorted;
}

}  // namespace

std::array<double, 9> turn_for(const PointMotion& m) {
  const Box box = box_of(m);
  Matrix spread{};
  for (std::size_t i = 0; i < m.points * m.frames.size(); ++i) {
    Vector v = at(m.truth, i);
    if (!there(v)) continue;
    for (std::size_t k = 0; k < 3; ++k) v[k] -= box.middle[k];
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) spread[3 * j + k] += v[j] * v[k] / (box.side * box.side);
  }
  Matrix axes = axes_of(spread);
  for (std::size_t k = 0; k < 3; ++k)  // right-handed
    axes[6 + k] = axes[(k + 1) % 3] * axes[3 + (k + 2) % 3] - axes[(k + 2) % 3] * axes[3 + (k + 1) % 3];
  const double yaw = 0.45, pitch = 0.3;
  const Matrix across{std::cos(yaw), 0, std::sin(yaw), 0, 1, 0, -std::sin(yaw), 0, std::cos(yaw)};
  const Matrix up{1, 0, 0, 0, std::cos(pitch), -std::sin(pitch), 0, std::sin(pitch), std::cos(pitch)};
  return product(up, product(across, axes));
}

std::string html(const PointMotion& m) {
  const Box box = box_of(m);
  const double full = full_distance(m);
  std::string links, numbers, turn, ramp;
  for (const auto& [a, b] : m.links) links += (links.empty() ? "" : " ") + std::to_string(a) + " " + std::to_string(b);
  for (const int f : m.frames) numbers += (numbers.empty() ? "" : " ") + std::to_string(f);
  for (const double t : m.turn) turn += format(turn.empty() ? "%.6f" : " %.6f", t);
  for (int k = 0; k < colours; ++k) ramp += (k > 0 ? "," : "") + hex(magnitude_colour(k / (colours - 1.0)));
  const std::string unit = m.unit.empty() ? std::string() : " / " + escape(m.unit);
  return "<div class=\"motion\" data-name=\"" + escape(m.name) + "\" data-points=\"" + std::to_string(m.points) +
         "\" data-frames=\"" + numbers + "\" data-links=\"" + links + "\" data-turn=\"" + turn +
         format("\" data-origin=\"%.9g %.9g %.9g\" data-step=\"%.9g\" data-middle=\"%.9g %.9g %.9g\"", box.low[0],
                box.low[1], box.low[2], box.side / steps, box.middle[0], box.middle[1], box.middle[2]) +
         format(" data-radius=\"%.9g\" data-full=\"%.9g\" data-unit=\"", box.radius, full) + escape(m.unit) +
         "\" data-colours=\"" + ramp + "\" data-codes=\"" + codes_of(m, box) + "\">" + still(m, box, full) +
         "<div class=\"scale\">distance from the truth" + unit +
         "<div class=\"ramp\" style=\"background:linear-gradient(to right," + ramp +
         ")\"></div><div class=\"ticks\"><span>0</span><span>" + number_text(full / 2, 2) + "</span><span>" +
         number_text(full, 2) + " and more</span></div></div></div>";
}

}  // namespace gonio::report
