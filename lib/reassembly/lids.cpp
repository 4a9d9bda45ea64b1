// A piece comes to rest on another: see lids.h. Local frame: z along down, as in contact_overlay.h.
#include "reassembly/lids.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "base/text.h"
#include "linear/geom_matrices.h"
#include "linear/solve.h"
#include "mesh/topology.h"
#include "mesh/verdict.h"
#include "reassembly/contact_overlay.h"
#include "reassembly/contact_plane.h"
#include "reassembly/lids_rest.h"

namespace gonio::reassembly {
namespace {

using contact::Layered;
using Six = Eigen::Matrix<double, 6, 6>;
using SixVector = Eigen::Matrix<double, 6, 1>;

Vec3 centre_of_mass(const io::TriangleMesh& mesh, const std::string& which, const std::string& place) {
  mesh::Mesh shape;
  shape.positions_m = mesh.positions_m;
  shape.triangles = mesh.triangles;
  const bool closed = !shape.triangles.empty() && mesh::topology_of(shape).closed();
  if (!closed)
    throw Error(Exit::data, place, "the mesh of " + which + " is not closed: it has no centre of mass",
                "close it (ct-mesh-clean)");
  Vec3 sum{};
  double volume = 0;  // six times
  const Vec3 origin = mesh.positions_m.front();
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 p = mesh.positions_m[a] - origin, q = mesh.positions_m[b] - origin, r = mesh.positions_m[c] - origin;
    const double part = dot(p, cross(q, r));
    volume += part;
    sum += part * (p + q + r) / 4;
  }
  return origin + sum / volume;
}

// Of a small motion about `centre`, from that about the piece's own point: v' = v + w x (centre - at).
Six carried_to(const StandingPiece& piece, Vec3 centre) {
  Six about;
  for (Eigen::Index i = 0; i < 6; ++i)
    for (Eigen::Index j = 0; j < 6; ++j) about(i, j) = piece.covariance[static_cast<std::size_t>(6 * i + j)];
  Six j = Six::Identity();
  j.block<3, 3>(3, 0) = -linear::cross_matrix(linear::as_eigen(centre - piece.at_m));
  return j * about * j.transpose();
}

io::TriangleMesh in_world(const StandingPiece& piece) {
  io::TriangleMesh mesh;
  mesh.triangles = piece.mesh->triangles;
  for (const Vec3& p : piece.mesh->positions_m) mesh.positions_m.push_back(piece.world_from_object * p);
  return mesh;
}

class Seating {
 public:
  Seating(const StandingPiece& upper, const StandingPiece& lower, Vec3 down, const SettleWish& wish,
          const std::string& place)
      : upper_(upper),
        lower_(lower),
        wish_(wish),
        basis_(normalized(down)),
        upper_world_(in_world(upper)),
        lower_world_(in_world(lower)),
        centre_(centre_of_mass(upper_world_, upper.object, place)) {
    centre_of_mass(lower_world_, lower.object, place);  // closed as well
    reach_m_ = wish.reach_m > 0 ? wish.reach_m : 0.07 * contact::extent_of(upper_world_).diagonal;
    for (const Vec3& p : upper_world_.positions_m) from_.push_back(basis_.to_local(p - centre_));
    for (const Vec3& p : lower_world_.positions_m) below_.at.push_back(basis_.to_local(p - centre_));
    for (const auto& f : lower_world_.triangles) {
      const Vec3 &a = below_.at[f[0]], &b = below_.at[f[1]], &c = below_.at[f[2]];
      if (cross(b - a, c - a).z < 0) below_.faces.push_back(f);
    }
    Six turn = Six::Zero();
    for (int k = 0; k < 2; ++k) {
      turn.block<1, 3>(3 * k, 3 * k) = linear::as_eigen(basis_.t).transpose();
      turn.block<1, 3>(3 * k + 1, 3 * k) = linear::as_eigen(basis_.b).transpose();
      turn.block<1, 3>(3 * k + 2, 3 * k) = linear::as_eigen(basis_.n).transpose();
    }
    covariance_ = turn * (carried_to(upper, centre_) + carried_to(lower, centre_)) * turn.transpose();
    // Poses that are said to be exact are known to a microradian and a tenth of a micrometre.
    for (Eigen::Index k = 0; k < 6; ++k) covariance_(k, k) += k < 3 ? 1e-12 : 1e-14;
  }

  Seat seat() const { return seat_at(nudge()); }

  Settled settled() {
    const Vec2 first = nudge();
    Settled result{seat_at(first), upper_.world_from_object, {}, {}, 0, {}, {}};
    if (result.before.standing == Standing::apart) {
      result.refused = format("nothing of \"%s\" lies under \"%s\" within %.3g mm", lower_.object.c_str(),
                              upper_.object.c_str(), 1e3 * reach_m_);
      return result;
    }
    // Where sides meet, a little farther off from them may be nearer to rest: the least motion of these.
    const Seat before = result.before;
    std::optional<Settled> best;
    for (const double more : {0.0, 0.1, 0.3, 0.6}) {
      if (more > 0 && !(norm(first) > 0)) break;
      Settled tried{before, upper_.world_from_object, {}, {}, 0, {}, {}};
      tried.refused = come_to_rest(tried, norm(first) > 0 ? first * (1 + more / norm(first)) : first);
      if (tried.refused.empty()) tried.refused = moved(tried);
      const bool better = !best || (tried.refused.empty() && (!best->refused.empty() || tried.sigmas < best->sigmas));
      if (better) best = std::move(tried);
    }
    result = std::move(*best);
    if (!result.refused.empty()) {
      result.world_from_object = upper_.world_from_object;
      result.turn_rad = result.shift_m = {};
      result.feet_m.clear();
    }
    return result;
  }

 private:
  std::vector<Gap> gaps_at(Vec3 turn, Vec3 shift) const {
    Layered above{{}, upper_world_.triangles};
    const Mat3 r = matrix_of(quaternion_of_rotation_vector(turn));
    for (const Vec3& p : from_) above.at.push_back(r * p + shift);
    const std::vector<std::uint8_t> all(below_.at.size(), 1), faces(below_.faces.size(), 1);
    std::vector<Gap> gaps;
    for (const contact::Row& row : rows_below(below_, above, {reach_m_, 0, all, all, faces}))
      gaps.push_back({row.where(below_.at) - shift, {row.slope.x, row.slope.y, -1}, -row.bound});
    return gaps;
  }

  Seat seat_at(Vec2 off) const {
    Seat seat;
    Vec3 turn{}, shift{};
    follow(turn, shift, off);
    const std::vector<Gap> gaps = gaps_at(turn, shift);
    if (gaps.empty()) return seat;
    const Gap& least = *std::ranges::min_element(gaps, {}, &Gap::gap);
    const Vec3 lever = cross(least.at, least.normal);
    const SixVector a{lever.x, lever.y, lever.z, least.normal.x, least.normal.y, least.normal.z};
    seat.gap_m = least.gap;
    seat.sigma_m = std::sqrt(a.dot(covariance_ * a));
    seat.where_m = centre_ + basis_.to_world(least.at + shift);
    seat.standing = least.gap > wish_.most_sigma * seat.sigma_m    ? Standing::floats
                    : least.gap < -wish_.most_sigma * seat.sigma_m ? Standing::sinks
                                                                   : Standing::touches;
    return seat;
  }

  // A plug whose side overlaps the neck by a hair is, along down, in it as deep as it is long. Where a shift across
  // that its pose allows frees it, that is what is wrong: the smallest such one, in standard deviations; else none.
  Vec2 nudge() const {
    if (seat_at({}).standing != Standing::sinks) return {};
    constexpr int directions = 12, halvings = 5;
    double stuck = 0;
    for (const double ring : {0.25, 0.5, 1.0, 1.5, 2.0, 2.5}) {
      if (ring > wish_.most_sigma) break;
      std::optional<Vec2> best;
      double widest = 0;
      for (int k = 0; k < directions; ++k) {
        const Vec2 way{std::cos(2 * pi * k / directions), std::sin(2 * pi * k / directions)};
        const Seat there = seat_at(way * ring);
        if (there.standing == Standing::sinks || there.standing == Standing::apart || (best && there.gap_m <= widest))
          continue;
        best = way;
        widest = there.gap_m;
      }
      if (best) {
        double free = ring;
        for (int k = 0; k < halvings; ++k) {
          const double middle = (stuck + free) / 2;
          (seat_at(*best * middle).standing == Standing::sinks ? stuck : free) = middle;
        }
        return *best * free;
      }
      stuck = ring;
    }
    return {};
  }

  // Across, and about down, as the covariance has it where sinking and tilting are known; `off` that by so many
  // standard deviations.
  void follow(Vec3& turn, Vec3& shift, Vec2 off) const {
    const std::array<Eigen::Index, 3> w{5, 0, 1}, h{3, 4, 2};
    const auto part = [&](const std::array<Eigen::Index, 3>& rows, const std::array<Eigen::Index, 3>& columns) {
      Eigen::Matrix3d m;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = covariance_(rows[i], columns[j]);
      return m;
    };
    const Eigen::Matrix3d known = part(w, w), with = part(h, w);
    const Eigen::Matrix3d left = part(h, h) - with * linear::inverse(known) * with.transpose();
    const double x_sd = std::sqrt(left(0, 0)), along = left(1, 0) / x_sd;  // Cholesky's factor
    const double y_sd = std::sqrt(std::max(0.0, left(1, 1) - along * along));
    // The turn about down goes with the shift as they vary together.
    const Eigen::Vector3d nudged{
        off.x * x_sd, off.x * along + off.y * y_sd,
        off.x * left(2, 0) / x_sd + (y_sd > 0 ? off.y * (left(2, 1) - along * left(2, 0) / x_sd) / y_sd : 0)};
    const Eigen::Vector3d follows = with * linear::solve_ldlt(known, Eigen::Vector3d(shift.z, turn.x, turn.y)) + nudged;
    shift = {follows[0], follows[1], shift.z};
    turn = {turn.x, turn.y, follows[2]};
  }

  // Linear programmes one after the other, each about where the last one led.
  std::string come_to_rest(Settled& result, Vec2 off) const {
    constexpr int most_steps = 60;
    Vec3 turn{}, shift{};
    follow(turn, shift, off);
    for (int step = 0; step < most_steps; ++step) {
      const std::vector<Gap> gaps = gaps_at(turn, shift);
      const Rest rest = rest_on(gaps, {.clearance = wish_.clearance_m, .most_tilt = 0.05, .most_sinking = reach_m_});
      if (rest.falls)
        return format("\"%s\" would tip off \"%s\": its centre of mass is not above what it stands on",
                      upper_.object.c_str(), lower_.object.c_str());
      const Vec3 before_turn = turn, before_shift = shift;
      turn = rotation_vector_of(quaternion_of_rotation_vector({rest.tilt.x, rest.tilt.y, 0}) *
                                quaternion_of_rotation_vector(turn));
      shift.z += rest.sinking;
      follow(turn, shift, off);
      result.feet_m.clear();
      for (const std::size_t k : rest.feet) result.feet_m.push_back(centre_ + basis_.to_world(gaps[k].at + shift));
      const double moved_m = norm(shift - before_shift) + norm(turn - before_turn) * reach_m_ / 0.07;
      if (moved_m < 0.01 * wish_.clearance_m) break;
    }
    // What the last programme left, by lifting alone.
    double least = std::numeric_limits<double>::infinity();
    for (const Gap& g : gaps_at(turn, shift)) least = std::min(least, g.gap);
    if (least < wish_.clearance_m / 2) shift.z -= wish_.clearance_m - least;
    result.turn_rad = basis_.to_world(turn);
    result.shift_m = basis_.to_world(shift);
    const SixVector motion{turn.x, turn.y, turn.z, shift.x, shift.y, shift.z};
    result.sigmas = std::sqrt(motion.dot(linear::solve_ldlt(covariance_, motion)));
    if (!(result.sigmas <= wish_.most_sigma))
      return format(
          "\"%s\" would have to move by %.3g mm and %.3g degrees to rest on \"%s\": %.3g standard deviations "
          "of its pose (limit %.3g)",
          upper_.object.c_str(), 1e3 * norm(result.shift_m), 180 / pi * norm(result.turn_rad), lower_.object.c_str(),
          result.sigmas, wish_.most_sigma);
    return {};
  }

  std::string moved(Settled& result) const {
    const Quaternion turn = quaternion_of_rotation_vector(result.turn_rad);
    const Rigid<frame::World, frame::World> motion{turn, centre_ + result.shift_m - matrix_of(turn) * centre_};
    result.world_from_object = motion * upper_.world_from_object;
    StandingPiece there = upper_;
    there.world_from_object = result.world_from_object;
    const std::size_t met = mesh::intersections(in_world(there), lower_world_).size();
    if (met == 0) return {};
    return format(
        "at rest on \"%s\" \"%s\" still meets it in %zu pairs of triangles: beside the seat, where neither "
        "sinking nor tilting helps",
        lower_.object.c_str(), upper_.object.c_str(), met);
  }

  const StandingPiece &upper_, &lower_;
  const SettleWish& wish_;
  Basis basis_;
  io::TriangleMesh upper_world_, lower_world_;
  Vec3 centre_;  // of the upper piece's mass, world: the local frame's origin
  double reach_m_ = 0;
  std::vector<Vec3> from_;  // the upper piece's vertices where its markers put them, local
  Layered below_;           // the lower piece's upper side, local
  Six covariance_;          // of the upper piece's motion against the lower's, about the centre of mass, local
};

}  // namespace

Seat seat_of(const StandingPiece& upper, const StandingPiece& lower, Vec3 down, const SettleWish& wish) {
  return Seating(upper, lower, down, wish, upper.object).seat();
}

Settled settle(const StandingPiece& upper, const StandingPiece& lower, Vec3 down, const SettleWish& wish,
               const std::string& place) {
  return Seating(upper, lower, down, wish, place).settled();
}

}  // namespace gonio::reassembly
