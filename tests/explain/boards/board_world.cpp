// See board_world.h. The lens acts on (t cos, t sin) of the ray's angle; the board's arc keeps its length, as paper
// does.
#include "explain/boards/board_world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>

namespace gonio::prove {
namespace {

using V3 = std::array<double, 3>;
using M3 = std::array<V3, 3>;
double normal(std::mt19937_64& g) {
  return std::normal_distribution<double>()(g);
}
double between(std::mt19937_64& g, double a, double b) {
  return std::uniform_real_distribution<double>(a, b)(g);
}

M3 product(const M3& a, const M3& b) {
  M3 c{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) c[i][j] += a[i][k] * b[k][j];
  return c;
}
M3 turn(int axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  if (axis == 0) return {{{1, 0, 0}, {0, c, -s}, {0, s, c}}};
  if (axis == 1) return {{{c, 0, s}, {0, 1, 0}, {-s, 0, c}}};
  return {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
}

// A strip of half length h whose middle stands `sag` above its ends, bent to an arc: where a point at s ends up (along,
// height).
std::array<double, 2> on_arc(double s, double h, double sag) {
  if (sag == 0) return {s, 0};
  const double radius = (h * h + sag * sag) / (2 * sag), angle = s / radius;
  return {radius * std::sin(angle), radius * (std::cos(angle) - std::cos(h / radius))};
}

// From the first corner to the board's middle.
V3 middle_of(const CaseDesign& d) {
  return {0.5 * (d.columns - 1) * d.square_m, 0.5 * (d.rows - 1) * d.square_m, 0};
}

V3 on_board(int column, int row, const BoardTruth& b, const CaseDesign& d) {
  const double half_x = middle_of(d)[0], half_y = middle_of(d)[1];
  const auto x = on_arc(column * d.square_m - half_x, half_x, b.sag_x_m);
  const auto y = on_arc(row * d.square_m - half_y, half_y, b.sag_y_m);
  const double aside = b.uneven_m == 0 ? 0 : b.uneven_m * std::sin(1.9 * column);
  return {half_x + x[0] * (1 + b.stretch_x) + aside, half_y + y[0], x[1] + y[1]};
}

std::array<double, 2> through_lens(double x, double y, const LensTruth& lens) {
  const double t2 = x * x + y * y, t = std::sqrt(t2);
  double scale = 1 + lens.k1 * t2 + lens.k2 * t2 * t2 + lens.k3 * t2 * t2 * t2;
  if (lens.division != 0 && t > 0) {
    // r (1 - ...) : t = r / (1 + l r^2)  =>  l t r^2 - r + t = 0, the root that goes to t for small l.
    const double l = lens.division;
    scale = (1 - std::sqrt(1 - 4 * l * t2)) / (2 * l * t2);
  }
  return {x * scale + 2 * lens.p1 * x * y + lens.p2 * (t2 + 2 * x * x) + lens.s1 * t2,
          y * scale + 2 * lens.p2 * x * y + lens.p1 * (t2 + 2 * y * y) + lens.s3 * t2};
}

// Where the entrance pupil stands for a point `across` from the axis and z ahead: the ray's angle by bisection.
double pupil_of(double pupil_m, double across, double z) {
  double low = 0, high = 1.5;
  for (int step = 0; step < 60; ++step) {
    const double angle = 0.5 * (low + high), at = pupil_m * std::sin(angle) * std::sin(angle);
    (std::atan2(across, z - at) > angle ? low : high) = angle;
  }
  return pupil_m * std::sin(low) * std::sin(low);
}

struct View {
  M3 rotation;
  V3 origin{};    // of the board, in the camera, when the middle row is read
  V3 velocity{};  // of the board, metres per readout
};
View random_view(const CaseTruth& truth, const CaseDesign& d, std::mt19937_64& g) {
  View v;
  if (d.frontal) {
    const V3 half = middle_of(d);
    v.rotation = turn(2, 0.003 * normal(g));
    v.origin = {between(g, -0.03, 0.03) - half[0], between(g, -0.02, 0.02) - half[1], 0.35 + 0.002 * normal(g)};
    return v;
  }
  v.rotation =
      product(turn(2, between(g, -0.4, 0.4)), product(turn(1, between(g, -0.6, 0.6)), turn(0, between(g, -0.6, 0.6))));
  const double z = between(g, 0.28, 0.5);
  const V3 middle = {between(g, -0.22, 0.22) * z, between(g, -0.15, 0.15) * z, z};
  const V3 half = middle_of(d);
  for (std::size_t i = 0; i < 3; ++i) v.origin[i] = middle[i] - v.rotation[i][0] * half[0] - v.rotation[i][1] * half[1];
  if (truth.rolling_px == 0) return v;
  const double way = truth.rolling_px * z / d.focal_px, towards = between(g, 0, 2 * std::acos(-1.0));
  v.velocity = {way * std::cos(towards), way * std::sin(towards), 0};
  return v;
}

struct Photograph {
  int channel = 1;
  double warmer_K = 0;
};

// Where a point of the board (in the camera's axes, from the board's origin) is seen. Its row is read when it is read:
// the moment is found by stepping, as the shutter does, not from a formula.
std::array<double, 2> seen_at(const V3& point, const View& view, const Photograph& photograph, const CaseTruth& truth,
                              const CaseDesign& d) {
  std::array<double, 2> pixel{};
  double moment = 0;
  for (int step = 0; step < 6; ++step) {
    V3 c = point;
    for (std::size_t i = 0; i < 3; ++i) c[i] += view.origin[i] + moment * view.velocity[i];
    if (truth.lens.pupil_m != 0) c[2] -= pupil_of(truth.lens.pupil_m, std::hypot(c[0], c[1]), c[2]);
    const auto image_point = through_lens(c[0] / c[2], c[1] / c[2], truth.lens);
    const double more = image_point[0] * image_point[0] + image_point[1] * image_point[1];
    const double larger = photograph.channel == 0   ? truth.lens.red + truth.lens.red_more * more
                          : photograph.channel == 2 ? truth.lens.blue + truth.lens.blue_more * more
                                                    : 0;
    const double focal = d.focal_px * (1 + truth.drift.focal * photograph.warmer_K) * (1 + larger);
    pixel = {focal * image_point[0] + 0.5 * d.width_px + 2 + truth.drift.x_px * photograph.warmer_K,
             focal * 1.001 * image_point[1] + 0.5 * d.height_px - 2 + truth.drift.y_px * photograph.warmer_K};
    moment = (pixel[1] + 0.5) / d.height_px - 0.5;
  }
  return pixel;
}

void print(std::string& text, const char* format, auto... values) {
  std::array<char, 600> line{};
  std::snprintf(line.data(), line.size(), format, values...);
  text += line.data();
}

// The corner table's rows of one view in one colour, or nothing where the board leaves the picture.
std::string corner_rows(const View& view, const Photograph& photograph, bool upside_down, const CaseTruth& truth,
                        const CaseDesign& d, double noise_px, const std::string& image, std::mt19937_64& g) {
  std::string text;
  const double obliqueness = 1 / std::max(0.3, std::abs(view.rotation[2][2]));
  for (int row = 0; row < d.rows; ++row)
    for (int column = 0; column < d.columns; ++column) {
      const V3 p = on_board(column, row, truth.board, d);
      V3 turned{};
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) turned[i] += view.rotation[i][k] * p[k];
      auto [u, v] = seen_at(turned, view, photograph, truth, d);
      if (u < 4 || v < 4 || u > d.width_px - 4 || v > d.height_px - 4) return "";
      u += truth.wave_px * std::sin(u / 22.0) + (upside_down ? -truth.bias_x_px : truth.bias_x_px);
      const double sigma = noise_px * (0.8 + 0.2 * obliqueness), misplaced = between(g, 0, 1) < d.misplaced ? 8 : 0;
      u += sigma * normal(g) + misplaced * normal(g);
      v += sigma * normal(g) + misplaced * normal(g);
      print(text, "%s[\"%s\",%d,%.6f,%.6f,%.5f,%.5f,0.1", text.empty() ? "" : ",", image.c_str(),
            row * d.columns + column, column * d.square_m, row * d.square_m, u, v);
      if (d.coloured) print(text, ",%d", photograph.channel);
      if (d.turned) print(text, ",%.10g", upside_down ? std::acos(-1.0) : 0.0);
      text += "]";
    }
  return text;
}

// All rows of one photograph, in one colour or three.
std::string photograph_rows(const View& view, double warmer_K, bool upside_down, const CaseTruth& truth,
                            const CaseDesign& d, double noise_px, const std::string& image, std::mt19937_64& g) {
  if (!d.coloured) return corner_rows(view, {1, warmer_K}, upside_down, truth, d, noise_px, image, g);
  std::string all;
  for (int channel = 0; channel < 3; ++channel) {
    const std::string rows = corner_rows(view, {channel, warmer_K}, upside_down, truth, d, noise_px, image, g);
    if (rows.empty()) return "";
    all += (channel == 0 ? "" : ",") + rows;
  }
  return all;
}

// What a first calibration hands over: poses that are a little off; of a fixed target, the same for all its pictures.
std::string stated_pose(const View& view, std::mt19937_64& g) {
  std::string text;
  const M3 r = product(turn(0, 0.004 * normal(g)), product(turn(1, 0.004 * normal(g)), view.rotation));
  for (std::size_t i = 0; i < 3; ++i)
    print(text, "[%.15g,%.15g,%.15g,%.9g],", r[i][0], r[i][1], r[i][2], view.origin[i] * (1 + 0.002 * normal(g)));
  return "\"camera_from_board\":{\"matrix\":[" + text + "[0,0,0,1]]}";
}

}  // namespace

BoardCase board_case(const std::string& name, const CaseTruth& truth, std::size_t views, std::uint64_t seed,
                     const CaseDesign& design) {
  std::mt19937_64 g(seed);
  const double noise_px = between(g, design.least_noise_px, design.most_noise_px);
  std::string images, table;
  const std::size_t last = views * static_cast<std::size_t>(design.takes) - 1;
  for (std::size_t made = 0; made <= last;) {
    const View view = random_view(truth, design, g);
    std::string pose;
    for (int take = 0; take < design.takes; ++take) {
      const std::string id = "view" + std::to_string(made);
      const double temperature_K = 295 + design.warming_K * static_cast<double>(made) / static_cast<double>(last);
      const std::string corners =
          photograph_rows(view, temperature_K - 295, design.turned && made % 2 == 1, truth, design, noise_px, id, g);
      if (corners.empty()) break;
      table += (made == 0 ? "" : ",") + corners;
      if (pose.empty()) pose = stated_pose(view, g);
      images += (made == 0 ? "" : ",");
      images += "{\"id\":\"" + id + "\",\"camera\":\"c\",\"board\":\"b\",";
      if (design.warming_K != 0) print(images, "\"temperature_K\":%.6f,", temperature_K);
      images += pose + "}";
      ++made;
    }
  }
  BoardCase result{name, "", truth};
  print(result.manifest,
        "{\"gonio\":1,\"boards\":{\"b\":{\"kind\":\"checkerboard\",\"inner_corners\":[%d,%d],\"square_m\":%g}},"
        "\"cameras\":{\"c\":{\"model\":\"%s\",\"width_px\":%d,\"height_px\":%d,\"fx_px\":%g,\"fy_px\":%g,\"cx_px\":%g,"
        "\"cy_px\":%g%s}},"
        "\"images\":[",
        design.columns, design.rows, design.square_m, design.knows_lens ? "radial-tangential" : "pinhole",
        design.width_px, design.height_px, 1.01 * design.focal_px, 1.01 * design.focal_px, 0.5 * design.width_px,
        0.5 * design.height_px, design.knows_lens ? ",\"distortion\":{\"k1\":0,\"k2\":0,\"p1\":0,\"p2\":0}" : "");
  std::string further;
  if (design.coloured) further += ",\"channel\":\"1\"";
  if (design.turned) further += ",\"turned_rad\":\"rad\"";
  result.manifest +=
      images +
      "],\"tables\":{\"corners\":{\"model\":\"camera\",\"camera\":\"c\",\"board\":\"b\",\"columns\":{\"image\":\"\","
      "\"corner\":\"1\",\"board_x_m\":\"m\",\"board_y_m\":\"m\",\"u_px\":\"px\",\"v_px\":\"px\",\"sigma_px\":\"px\"" +
      further +
      "},"
      "\"observed\":[\"u_px\",\"v_px\"],\"sigma\":[\"sigma_px\"],\"rows\":[" +
      table + "]}}}\n";
  return result;
}

std::vector<BoardCase> all_board_cases(std::uint64_t seed, std::size_t repeats) {
  std::mt19937_64 g(seed);
  std::vector<CaseTruth> truths;
  const auto sign = [&] { return between(g, 0, 1) < 0.5 ? -1.0 : 1.0; };
  for (std::size_t k = 0; k < repeats; ++k) {
    for (int nothing = 0; nothing < 4; ++nothing) truths.push_back({});
    CaseTruth t;
    t.effects = {"lens.radial"};
    t.lens.k1 = sign() * between(g, 0.03, 0.25);
    t.lens.k2 = between(g, -0.1, 0.1);
    truths.push_back(t);
    t.lens = {};
    t.lens.division = sign() * between(g, 0.03, 0.2);
    truths.push_back(t);
    t = {};
    t.effects = {"lens.tangential"};
    t.lens.p1 = sign() * between(g, 0.004, 0.012);
    t.lens.p2 = sign() * between(g, 0.004, 0.012);
    truths.push_back(t);
    t = {};
    t.effects = {"lens.thin-prism"};
    t.lens.s1 = sign() * between(g, 0.006, 0.02);
    t.lens.s3 = sign() * between(g, 0.006, 0.02);
    truths.push_back(t);
    t = {};
    t.effects = {"board.warp"};
    t.board.sag_x_m = sign() * between(g, 0.0003, 0.0015);
    t.board.sag_y_m = sign() * between(g, 0.0003, 0.0015);
    truths.push_back(t);
    t.effects = {"board.warp", "lens.radial"};
    t.lens.k1 = sign() * between(g, 0.03, 0.25);
    truths.push_back(t);
    t = {};
    t.effects = {"board.scale"};
    t.board.stretch_x = sign() * between(g, 0.003, 0.008);
    truths.push_back(t);
    t = {};
    t.outside = true;
    t.wave_px = between(g, 0.3, 0.6);
    truths.push_back(t);
  }
  std::shuffle(truths.begin(), truths.end(), g);
  std::vector<BoardCase> cases;
  for (const CaseTruth& truth : truths) {
    const std::string name = "case-" + std::to_string(cases.size() + 1);
    cases.push_back(board_case(name, truth, 10 + g() % 6, g()));
  }
  return cases;
}

}  // namespace gonio::prove
