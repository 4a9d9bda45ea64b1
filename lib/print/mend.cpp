// See mend.h.
#include "print/mend.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "mesh/inside.h"
#include "mesh/mend/edges.h"
#include "mesh/mend/faces.h"
#include "mesh/mend/holes.h"
#include "mesh/mend/unite.h"
#include "mesh/mesh.h"
#include "mesh/verdict.h"

namespace gonio::print {
namespace {

constexpr double torn_share = 1e-5, hole_share = 0.05;  // of the diagonal
constexpr double most_closing = 0.5;                    // of a piece's area
constexpr double flat_volume = 1e-10;                   // over area^(3/2)
constexpr std::size_t most_crossings = std::size_t{1} << 22;

struct Box {
  Vec3 low{}, high{};
  bool within(const Box& o) const {
    return low.x >= o.low.x && low.y >= o.low.y && low.z >= o.low.z && high.x <= o.high.x && high.y <= o.high.y &&
           high.z <= o.high.z;
  }
};

struct Piece {
  std::vector<std::array<std::uint32_t, 3>> triangles{};
  Box box{};
  double area_m2 = 0, volume_m3 = 0;
};

double area_of(const io::TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Vec3 p = mesh.positions_m[t[0]];
  return norm(cross(mesh.positions_m[t[1]] - p, mesh.positions_m[t[2]] - p)) / 2;
}

void include(Box& box, Vec3 p) {
  box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
  box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
}

std::vector<Piece> pieces_of(const io::TriangleMesh& mesh) {
  std::size_t count = 0;
  const std::vector<std::uint32_t> piece = mesh::pieces_of(mesh, count);
  std::vector<Piece> pieces(count);
  for (std::size_t f = 0; f < piece.size(); ++f) {
    Piece& p = pieces[piece[f]];
    const auto& t = mesh.triangles[f];
    if (p.triangles.empty()) p.box = {mesh.positions_m[t[0]], mesh.positions_m[t[0]]};
    p.triangles.push_back(t);
    p.area_m2 += area_of(mesh, t);
    for (const std::uint32_t v : t) include(p.box, mesh.positions_m[v]);
  }
  for (Piece& p : pieces) {
    const Vec3 o = mesh.positions_m[p.triangles[0][0]];
    for (const auto& [a, b, c] : p.triangles)
      p.volume_m3 += dot(mesh.positions_m[a] - o, cross(mesh.positions_m[b] - o, mesh.positions_m[c] - o)) / 6;
  }
  return pieces;
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

class Mending {
 public:
  Mending(io::TriangleMesh mesh, const MendWish& wish, const std::string& place)
      : mesh_(std::move(mesh)), place_(place) {
    mesh::prepare(mesh_, mesh::Shading::flat, place);  // finite, indices that lead somewhere, some area
    Box box{mesh_.positions_m[0], mesh_.positions_m[0]};
    for (const auto& t : mesh_.triangles)
      for (const std::uint32_t v : t) include(box, mesh_.positions_m[v]);
    diagonal_m_ = norm(box.high - box.low);
    largest_hole_m_ = wish.largest_hole_m > 0 ? wish.largest_hole_m : hole_share * diagonal_m_;
  }

  Mended done() {
    faces();
    surfaces();
    close_holes();
    drop_flat();
    turn_outwards();
    unite();
    return result();
  }

 private:
  void say(std::size_t count, const char* one, const char* many) {
    if (count > 0) steps_.push_back(counted(count, one, many));
  }
  [[noreturn]] void refuse(const std::string& problem, const std::string& remedy) const {
    throw Error(Exit::data, place_, problem, remedy);
  }

  void faces() {
    const mesh::CleanedFaces cleaned = mesh::clean_faces(mesh_);
    say(cleaned.merged_vertices, "vertex was merged with another at its place",
        "vertices were merged with others at their places");
    say(cleaned.collapsed, "triangle with two corners at one place went",
        "triangles with two corners at one place went");
    say(cleaned.needles, "triangle without area was taken over by its neighbour",
        "triangles without area were taken over by their neighbours");
    say(cleaned.doubled, "copy of a triangle went", "copies of triangles went");
    say(cleaned.cancelled, "triangle of a sheet without thickness went", "triangles of sheets without thickness went");
    const std::size_t stitched = mesh::stitch_rims(mesh_, torn_share * diagonal_m_);
    say(stitched, "vertex of a torn rim was stitched", "vertices of torn rims were stitched");
    if (stitched > 0) mesh::clean_faces(mesh_);
    if (mesh_.triangles.empty()) refuse("is flat: its triangles lie on their own reverse", "give it a thickness");
  }

  void surfaces() {
    surfaces_ = mesh::make_surfaces(mesh_);
    if (surfaces_.one_sided > 0)
      refuse("has " + counted(surfaces_.one_sided, "piece that has", "pieces that have") +
                 " one side only, as a Moebius strip: no inside can be told",
             "repair it where it was made");
    say(surfaces_.crowded, "edge of more than two triangles was split", "edges of more than two triangles were split");
    say(surfaces_.turned, "triangle was turned to face as those about it do",
        "triangles were turned to face as those about them do");
  }

  void close_holes() {
    const std::vector<mesh::HoleRim> rims = mesh::rims_of(mesh_, surfaces_.piece);
    if (rims.empty()) return;
    std::vector<double> area(surfaces_.pieces, 0), closing(surfaces_.pieces, 0);
    for (std::size_t f = 0; f < mesh_.triangles.size(); ++f)
      area[surfaces_.piece[f]] += area_of(mesh_, mesh_.triangles[f]);
    double largest = 0;
    std::vector<std::array<std::uint32_t, 3>> fills;
    for (const mesh::HoleRim& rim : rims) {
      if ((rim.loop.size() > 3 && rim.diagonal_m > largest_hole_m_) || rim.loop.size() > mesh::longest_rim)
        refuse_open(rims, rim);
      largest = std::max(largest, rim.diagonal_m);
      for (const auto& t : mesh::closing_triangles(mesh_, rim.loop)) {
        fills.push_back(t);
        closing[rim.piece] += area_of(mesh_, t);
      }
      if (closing[rim.piece] > most_closing * area[rim.piece]) refuse_open(rims, rim);
    }
    mesh_.triangles.insert(mesh_.triangles.end(), fills.begin(), fills.end());
    // At an edge with a corner in its middle that one side alone knows the hole is a triangle without area.
    if (mesh::turn_needles(mesh_) > 0) surfaces_ = mesh::make_surfaces(mesh_);
    steps_.push_back(counted(rims.size(), "hole was closed", "holes were closed") + ", the largest " +
                     format("%.3g", largest) + " m across, with " + counted(fills.size(), "triangle", "triangles"));
  }

  [[noreturn]] void refuse_open(const std::vector<mesh::HoleRim>& rims, const mesh::HoleRim& rim) const {
    const Vec3 p = mesh_.positions_m[rim.loop[0]];
    refuse("is open: it has " + counted(rims.size(), "hole", "holes") + ", one of " + std::to_string(rim.loop.size()) +
               " edges and " + format("%.3g m across at (%.6g, %.6g, %.6g) m", rim.diagonal_m, p.x, p.y, p.z) +
               "; closed are holes of three edges and up to " + format("%.3g", largest_hole_m_) +
               " m, by less than half of what there is",
           "close it, or allow larger holes");
  }

  // Pieces that enclose nothing go.
  void drop_flat() {
    std::vector<Piece> pieces = pieces_of(mesh_);
    const std::size_t before = pieces.size();
    std::erase_if(pieces,
                  [](const Piece& p) { return !(std::abs(p.volume_m3) > flat_volume * std::pow(p.area_m2, 1.5)); });
    if (pieces.empty()) refuse("is flat: it encloses no volume", "give it a thickness");
    say(before - pieces.size(), "piece that encloses nothing went", "pieces that enclose nothing went");
    take(pieces);
  }

  void take(const std::vector<Piece>& pieces) {
    mesh_.triangles.clear();
    for (const Piece& p : pieces) mesh_.triangles.insert(mesh_.triangles.end(), p.triangles.begin(), p.triangles.end());
  }

  // Of every piece those that it lies in: their boxes and a place on it say so, and that they do not meet it.
  std::vector<std::vector<std::size_t>> nests(const std::vector<Piece>& pieces) {
    std::vector<std::vector<std::size_t>> within(pieces.size());
    if (pieces.size() == 1) return within;
    std::vector<std::size_t> piece;
    for (std::size_t i = 0; i < pieces.size(); ++i) piece.insert(piece.end(), pieces[i].triangles.size(), i);
    std::vector<std::pair<std::size_t, std::size_t>> meeting;
    for (const auto& [a, b] : mesh::self_intersections(mesh_, most_crossings))
      if (piece[a] != piece[b]) meeting.push_back(std::minmax(piece[a], piece[b]));
    std::ranges::sort(meeting);
    for (std::size_t j = 0; j < pieces.size(); ++j) {
      mesh::Mesh other;
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (i == j || !pieces[i].box.within(pieces[j].box)) continue;
        if (std::ranges::binary_search(meeting, std::pair<std::size_t, std::size_t>(std::minmax(i, j)))) continue;
        if (other.triangles.empty()) other.positions_m = mesh_.positions_m, other.triangles = pieces[j].triangles;
        const auto& [a, b, c] = pieces[i].triangles[0];
        const Vec3 centre = (mesh_.positions_m[a] + mesh_.positions_m[b] + mesh_.positions_m[c]) / 3;
        if (std::abs(mesh::winding_number(other, centre)) > 0.5) within[i].push_back(j);
      }
    }
    return within;
  }

  void turn_outwards() {
    std::vector<Piece> pieces = pieces_of(mesh_);
    take(pieces);  // in the order of the pieces, which meeting triangles are told by
    const auto within = nests(pieces);
    std::vector<std::size_t> order(pieces.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return within[i].size(); });
    std::vector<bool> outwards(pieces.size(), true);
    std::size_t turned = 0;
    for (const std::size_t i : order) {
      const bool stated = pieces[i].volume_m3 > 0;
      if (!within[i].empty()) {
        const std::size_t in =
            *std::ranges::max_element(within[i], {}, [&](std::size_t j) { return within[j].size(); });
        outwards[i] = stated && pieces[in].volume_m3 > 0 && outwards[in] ? true : !outwards[in];
      }
      if (outwards[i] == stated) continue;
      ++turned;
      for (auto& t : pieces[i].triangles) std::swap(t[1], t[2]);
    }
    say(turned, "piece was inside out", "pieces were inside out");
    take(pieces);
  }

  void unite() {
    const mesh::United united = mesh::unite(mesh_);
    if (united.given_up)
      refuse("meets itself in more than " + std::to_string(united.crossings) + " pairs of triangles",
             "unite its parts where it was made, or take fewer triangles");
    if (united.crossings > 0)
      steps_.push_back("what overlaps was united: " +
                       counted(united.crossings, "pair of triangles meets", "pairs of triangles meet") + ", " +
                       counted(united.cut_triangles, "triangle was cut", "triangles were cut"));
    say(united.within, "piece within the material of others went", "pieces within the material of others went");
    if (mesh_.triangles.empty()) refuse("is flat: it encloses no volume", "give it a thickness");
  }

  Mended result() {
    Mended mended;
    mesh::make_surfaces(mesh_);  // what touches is one vertex after the union
    for (const Piece& p : pieces_of(mesh_)) {
      ++(p.volume_m3 > 0 ? mended.bodies : mended.cavities);
      mended.volume_m3 += p.volume_m3;
    }
    if (!(mended.volume_m3 > 0) || !mesh::soundness(mesh_).closed())
      refuse("could not be mended: what is left is not closed", "repair it where it was made");
    mended.mesh = std::move(mesh_);
    mended.steps = std::move(steps_);
    return mended;
  }

  io::TriangleMesh mesh_;
  const std::string& place_;
  double diagonal_m_ = 0, largest_hole_m_ = 0;
  mesh::Surfaces surfaces_;
  std::vector<std::string> steps_;
};

}  // namespace

Mended mend(io::TriangleMesh mesh, const MendWish& wish, const std::string& place) {
  return Mending(std::move(mesh), wish, place).done();
}

}  // namespace gonio::print
