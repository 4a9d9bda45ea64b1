// See simulated_readings.h.
//
// Filtered back-projection is linear in the readings: a volume with an amount of a mechanism is the plain one less the
// amount times what its lacking readings are reconstructed to. Grey values are then read off at once; an edge is fitted
// anew, at an amount of the size that is met, for an edge's place is not linear in the values.
#include "explain/volumes/simulated_readings.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "stats/intervals.h"

namespace gonio::explain::volumes {
namespace {

constexpr double hardening_amount = 0.1, streak_amount = 0.02, usual_width = 0.6;

// The voxels that readings at the sites and at grey rows are interpolated from.
class Needed {
 public:
  Needed(const Sampled& sampled, const std::vector<Site>& sites, double reach, const std::vector<Row>& rows)
      : sampled_(sampled), marked_(sampled.volume().values.size(), 0) {
    std::vector<char> edge(sites.size(), 0);
    for (const Row& row : rows) {
      if (is_grey(row.reading))
        mark(row.at_m);
      else
        edge[row.site] = 1;
    }
    for (std::size_t s = 0; s < sites.size(); ++s) {
      if (!edge[s]) continue;
      const ProfileRange range = profile_range(sites[s], reach);
      for (double x = range.low; x <= range.high + 1e-9; x += profile_step)
        mark(sites[s].at_m + sites[s].normal * (x * sampled.voxel_m()));
    }
    const auto& n = sampled.volume().head.size;
    for (std::size_t v = 0; v < marked_.size(); ++v)
      if (marked_[v]) {
        voxels_.push_back(v);
        places_.push_back(sampled.place_of({static_cast<double>(v % n[0]), static_cast<double>(v / n[0] % n[1]),
                                            static_cast<double>(v / (n[0] * n[1]))}));
      }
  }
  const std::vector<std::size_t>& voxels() const { return voxels_; }
  const std::vector<Vec3>& places() const { return places_; }

 private:
  void mark(Vec3 place) {
    const Vec3 index = sampled_.index_of(place);
    const auto& n = sampled_.volume().head.size;
    std::array<std::size_t, 3> low{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double x = index[static_cast<int>(a)];
      if (!(x >= 0 && x <= static_cast<double>(n[a] - 1))) return;
      low[a] = static_cast<std::size_t>(x);
    }
    for (std::size_t c = 0; c < 8; ++c) {
      const std::size_t i = low[0] + (c & 1), j = low[1] + (c >> 1 & 1), k = low[2] + (c >> 2);
      if (i < n[0] && j < n[1] && k < n[2]) marked_[(k * n[1] + j) * n[0] + i] = 1;
    }
  }
  const Sampled& sampled_;
  std::vector<char> marked_;
  std::vector<std::size_t> voxels_;
  std::vector<Vec3> places_;
};

// Readings of one volume: an edge at every site, a grey value at every row.
struct Read {
  std::vector<volume::Edge> edges;
  std::vector<double> greys;
};

class Simulation {
 public:
  Simulation(const Tomograph& tomograph, const Sampled& sampled, const Values& values, const std::vector<Site>& sites,
             double reach, std::vector<Row>& rows)
      : tomograph_(tomograph),
        sampled_(sampled),
        values_(values),
        sites_(sites),
        reach_(reach),
        rows_(rows),
        needed_(sampled, sites, reach, rows) {
    volume_.head.size = sampled.volume().head.size;
    volume_.values.assign(sampled.volume().values.size(), 0.0f);
    const std::vector<Readings> plain{tomograph.read()};
    for (const auto& v : tomograph.reconstructed(plain, needed_.places())) plain_.push_back(v[0]);
    base_ = read(plain_);
  }
  const Read& base() const { return base_; }
  // Of up to four kinds of lacking readings, each at its amount.
  std::vector<Read> with(const std::vector<Readings>& lacks, const std::vector<double>& amounts) {
    const auto lacking = tomograph_.reconstructed(lacks, needed_.places());
    std::vector<Read> result;
    for (std::size_t k = 0; k < lacks.size(); ++k) {
      std::vector<float> v = plain_;
      for (std::size_t n = 0; n < v.size(); ++n) v[n] -= static_cast<float>(amounts[k]) * lacking[n][k];
      result.push_back(read(v));
    }
    return result;
  }

 private:
  Read read(const std::vector<float>& shares) {
    const double rise = values_.material - values_.air;
    for (std::size_t n = 0; n < shares.size(); ++n)
      volume_.values[needed_.voxels()[n]] = static_cast<float>(values_.air + rise * static_cast<double>(shares[n]));
    const Sampled simulated(volume_, sampled_.spacing_m());
    Read result{edges_of(simulated, sites_, values_, reach_), {}};
    for (const Row& row : rows_)
      result.greys.push_back(is_grey(row.reading) ? (simulated.at(row.at_m) - values_.air) / rise : 0);
    return result;
  }
  const Tomograph& tomograph_;
  const Sampled& sampled_;
  const Values& values_;
  const std::vector<Site>& sites_;
  double reach_;
  std::vector<Row>& rows_;
  Needed needed_;
  io::VolumeData volume_;
  std::vector<float> plain_;
  Read base_;
};

// By how much the reading of a row is less than the plain one; nothing where the edge is lost.
double lacked(const Row& row, std::size_t place, const Read& plain, const Read& changed) {
  if (is_grey(row.reading)) return plain.greys[place] - changed.greys[place];
  const volume::Edge &a = plain.edges[row.site], &b = changed.edges[row.site];
  if (!a.good || !b.good) return 0;
  return row.reading == Reading::wall ? a.position - b.position : a.width - b.width;
}

// What a wider edge does: an edge that is lost at a spread goes on as at the spread before.
void fill_blur(Row& row, std::size_t place, const Read& plain, const std::vector<Read>& blurred,
               const std::vector<Read>& of_spectrum) {
  for (std::size_t k = 0; k < blur_spreads.size(); ++k) {
    const double spread = blur_spreads[k], ratio = k == 0 ? 0 : spread / blur_spreads[k - 1];
    const auto lost = [&](const Read& read) { return !is_grey(row.reading) && !read.edges[row.site].good; };
    const std::size_t before = k == 0 ? 0 : k - 1;
    if (row.reading == Reading::width) {
      const double was = plain.edges[row.site].width, now = blurred[k].edges[row.site].width;
      row.blur[k] = !lost(blurred[k]) ? std::sqrt(std::max(0.0, now * now - was * was))
                    : k == 0          ? spread
                                      : row.blur[before] * ratio;
      continue;
    }
    row.blur[k] = lost(blurred[k]) ? row.blur[before] * ratio * ratio : lacked(row, place, plain, blurred[k]);
    row.blur_of_spectrum[k] = lost(of_spectrum[k]) || lost(blurred[k]) ? row.blur_of_spectrum[before] * ratio * ratio
                                                                       : lacked(row, place, blurred[k], of_spectrum[k]);
  }
}

void add_edges_and_greys(const Tomograph& tomograph, const Sampled& sampled, const Values& values,
                         const std::vector<Site>& sites, const std::vector<Ball>& markers, double reach,
                         std::vector<Row>& rows) {
  Simulation simulation(tomograph, sampled, values, sites, reach, rows);
  const Read& plain = simulation.base();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const volume::Edge& e = plain.edges[rows[i].site];
    rows[i].simulated = is_grey(rows[i].reading)            ? plain.greys[i]
                        : rows[i].reading == Reading::width ? e.width
                                                            : e.position;
  }
  std::vector<Readings> lacks, of_spectrum;
  for (const double spread : blur_spreads) {
    lacks.push_back(tomograph.lack_by_blur(spread, 0));
    of_spectrum.push_back(tomograph.lack_by_blur(spread, blur_variance));
  }
  const std::vector<double> ones(blur_spreads.size(), 1.0);
  const std::vector<Read> blurred = simulation.with(lacks, ones), softened = simulation.with(of_spectrum, ones);
  const std::vector<double> shares(scatter_shares.begin(), scatter_shares.end());
  const std::vector<Read> scattered = simulation.with(tomograph.lack_by_scatter(shares), shares);
  lacks = {tomograph.lack_by_hardening()};
  std::vector<double> amounts{hardening_amount};
  if (!markers.empty()) lacks.push_back(tomograph.lack_by_streak()), amounts.push_back(streak_amount);
  const std::vector<Read> hardened = simulation.with(lacks, amounts);
  std::vector<Read> behind_markers;
  const std::vector<double> floors(streak_floors.begin(), streak_floors.end()), whole(floors.size(), 1.0);
  if (!markers.empty()) behind_markers = simulation.with(tomograph.lack_by_floor(floors), whole);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    fill_blur(rows[i], i, plain, blurred, softened);
    for (std::size_t s = 0; s < shares.size(); ++s)
      rows[i].scatter[s] = lacked(rows[i], i, plain, scattered[s]) / shares[s];
    rows[i].hardening = lacked(rows[i], i, plain, hardened[0]) / amounts[0];
    if (hardened.size() > 1) rows[i].markers = lacked(rows[i], i, plain, hardened[1]) / amounts[1];
    for (std::size_t f = 0; f < behind_markers.size(); ++f)
      rows[i].floor[f] = lacked(rows[i], i, plain, behind_markers[f]) / floors[f];
  }
  std::vector<Row> kept;
  for (const Row& row : rows)
    if (is_grey(row.reading) ? std::isfinite(row.simulated) : plain.edges[row.site].good) kept.push_back(row);
  rows = std::move(kept);
}

// Pixels are larger than voxels: grey values alone.
void add_greys(const Tomograph& tomograph, const std::vector<Ball>& markers, std::vector<Row>& rows) {
  std::vector<Vec3> places;
  for (const Row& row : rows) places.push_back(row.at_m);
  const auto scatter = tomograph.reconstructed(tomograph.lack_by_scatter(scatter_shares), places);
  std::vector<Readings> lacks{tomograph.lack_by_hardening()};
  if (!markers.empty()) lacks.push_back(tomograph.lack_by_streak());
  const auto hardening = tomograph.reconstructed(lacks, places);
  std::vector<std::array<float, 4>> behind_markers(places.size());
  if (!markers.empty()) behind_markers = tomograph.reconstructed(tomograph.lack_by_floor(streak_floors), places);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Row& row = rows[i];
    if (row.reading == Reading::width) row.simulated = usual_width, row.blur = blur_spreads;
    if (!is_grey(row.reading)) continue;
    row.simulated = row.reading == Reading::inside ? 1 : 0;
    for (std::size_t s = 0; s < scatter_shares.size(); ++s) row.scatter[s] = static_cast<double>(scatter[i][s]);
    row.hardening = static_cast<double>(hardening[i][0]), row.markers = static_cast<double>(hardening[i][1]);
    for (std::size_t f = 0; f < streak_floors.size(); ++f)
      row.floor[f] = static_cast<double>(behind_markers[i][f]) / streak_floors[f];
  }
}

}  // namespace

std::vector<volume::Edge> edges_of(const Sampled& sampled, const std::vector<Site>& sites, const Values& values,
                                   double reach) {
  std::vector<volume::Edge> edges(sites.size());
  parallel_for(
      0, sites.size(), [&](std::size_t i) { edges[i] = edge_at(sampled, sites[i], values, reach); }, 32);
  return edges;
}

void add_simulated(const Tomograph& tomograph, const Sampled& sampled, const Values& values,
                   const std::vector<Site>& sites, const std::vector<Ball>& markers, double reach,
                   std::vector<Row>& rows, Observed& observed) {
  if (tomograph.is_fine())
    add_edges_and_greys(tomograph, sampled, values, sites, markers, reach, rows);
  else
    add_greys(tomograph, markers, rows);
  std::vector<double> widths;
  std::vector<Vec3> places;
  for (const Row& row : rows) {
    if (row.reading == Reading::width) widths.push_back(row.simulated);
    places.push_back(row.at_m);
  }
  observed.simulated_width = widths.empty() ? usual_width : stats::median(widths);
  const std::vector<double> path = tomograph.mean_reading(tomograph.read(), places);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].path_m = path[i];
  if (markers.empty()) return;
  const std::vector<double> marker_path = tomograph.mean_reading(paths(markers, tomograph.detector()), places);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].marker_path_m = marker_path[i];
}

}  // namespace gonio::explain::volumes
