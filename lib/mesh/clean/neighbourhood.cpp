#include "mesh/clean/neighbourhood.h"

#include <cmath>

#include "base/parallel.h"

namespace gonio::mesh {

namespace {

constexpr double least_agreement = 0.4;  // cosine

}  // namespace

NoisySurface::NoisySurface(const std::vector<Vec3>& positions, const std::vector<Corners>& corners)
    : positions_m(positions), triangles(corners), faces(corners.size()) {
  const std::vector<Corners> behind = neighbours_of_faces(triangles, positions_m.size());
  double sum = 0;
  for (std::size_t t = 0; t < faces.size(); ++t) {
    const Vec3 a = positions_m[triangles[t][0]], b = positions_m[triangles[t][1]], c = positions_m[triangles[t][2]];
    const Vec3 n = cross(b - a, c - a);
    faces[t] = {(a + b + c) / 3, norm(n) > 0 ? normalized(n) : Vec3{0, 0, 1}, triangles[t], behind[t], 0};
    sum += norm(b - a) + norm(c - b) + norm(a - c);
  }
  edge_m = faces.empty() ? 0 : sum / (3 * static_cast<double>(faces.size()));
}

std::unique_ptr<FaceAndVertexMarks> NoisySurface::borrow_marks() const {
  {
    const std::lock_guard hold(lock_);
    if (!marks_.empty()) {
      auto marks = std::move(marks_.back());
      marks_.pop_back();
      return marks;
    }
  }
  return std::make_unique<FaceAndVertexMarks>(FaceAndVertexMarks{Marks(faces.size()), Marks(positions_m.size())});
}

void NoisySurface::give_back(std::unique_ptr<FaceAndVertexMarks> marks) const {
  const std::lock_guard hold(lock_);
  marks_.push_back(std::move(marks));
}

std::size_t mark_sharp(NoisySurface& surface, double angle_rad) {
  std::size_t sharp = 0;
  const double cosine = std::cos(angle_rad);
  for (NoisyFace& face : surface.faces) {
    face.sharp = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t other = face.behind[c];
      if (other == nobody || dot(face.guide, surface.faces[other].guide) >= cosine) continue;
      face.sharp |= 1U << c;
      ++sharp;
    }
  }
  return sharp / 2;
}

void Neighbourhood::add_vertex(std::uint32_t v) {
  if (marks_->vertices.has(v)) return;
  marks_->vertices.set(v);
  vertices_.push_back(v);
}

void Neighbourhood::start(std::uint32_t face) {
  face_ = face;
  marks_->faces.clear();
  marks_->vertices.clear();
  vertices_.clear();
  beyond_.assign(1, {face, nobody, nobody});
  marks_->faces.set(face);
}

void Neighbourhood::grow(double radius_m) {
  const Vec3 centre = surface_.faces[face_].centroid, normal = surface_.faces[face_].guide;
  const double squared = radius_m * radius_m;
  queue_.clear();
  later_.clear();
  const auto sort_in = [&](const NoisyFace& face, const Reached& how) {
    const Vec3 gap = face.centroid - centre;
    (dot(gap, gap) <= squared ? queue_ : later_).push_back(how);
  };
  for (const Reached& how : beyond_) sort_in(surface_.faces[how.face], how);
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const Reached here = queue_[i];
    const NoisyFace& face = surface_.faces[here.face];
    if (here.apex != nobody)
      add_vertex(here.apex);
    else
      for (const std::uint32_t v : face.corners) add_vertex(v);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t other = face.behind[c];
      if (other == nobody || other == here.from || (face.sharp >> c & 1) != 0 || marks_->faces.has(other)) continue;
      const NoisyFace& next = surface_.faces[other];
      if (dot(next.guide, normal) < least_agreement) continue;
      marks_->faces.set(other);
      // The corner that is not on the edge: what three have beside two.
      const std::uint32_t apex =
          next.corners[0] ^ next.corners[1] ^ next.corners[2] ^ face.corners[c] ^ face.corners[(c + 1) % 3];
      sort_in(next, {other, here.face, apex});
    }
  }
  beyond_.swap(later_);
}

}  // namespace gonio::mesh
