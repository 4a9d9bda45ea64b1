// See files.h.
#include "nrsfm/files.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "io/ply.h"
#include "nrsfm/variables.h"

namespace gonio::nrsfm {
namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

void note(Notes* notes, const std::string& text) {
  if (notes != nullptr) notes->push_back(text);
}

[[noreturn]] void refuse(const std::string& place, const std::string& problem, const std::string& remedy = {}) {
  throw Error(Exit::data, place, problem, remedy);
}

// R is 2F x 3 or 3F x 3, T is F translations of 3.
std::vector<CameraFromObject> cameras_of(const Variables& file, const std::string& name, Eigen::Index frames) {
  const Eigen::MatrixXd r = file.matrix(name);
  const Eigen::Index rows = r.cols() == 3 && r.rows() == 3 * frames ? 3 : 2;
  if (r.cols() != 3 || r.rows() != rows * frames)
    refuse(file.place(name), "is " + std::to_string(r.rows()) + " x " + std::to_string(r.cols()) + " where " +
                                 std::to_string(frames) + " frames make it 2F x 3 or 3F x 3");
  std::vector<CameraFromObject> cameras(static_cast<std::size_t>(frames));
  for (Eigen::Index f = 0; f < frames; ++f) {
    Eigen::Matrix3d& m = cameras[static_cast<std::size_t>(f)].rotation;
    m.topRows<2>() = r.middleRows<2>(rows * f);
    m.row(2) = m.row(0).cross(m.row(1));
    if (const double off = (m * m.transpose() - Eigen::Matrix3d::Identity()).norm(); !(off < 1e-4))
      refuse(file.place(name), "has rows that are not orthonormal in frame " + std::to_string(f) +
                                   " (|R R' - I| = " + std::to_string(off) + ", limit 1e-4)");
  }
  if (file.find("T") != nullptr) {
    const Eigen::MatrixXd t = file.matrix("T");
    if (t.size() != 3 * frames)
      refuse(file.place("T"), "has " + std::to_string(t.size()) + " numbers, 3 a frame are needed");
    const bool by_rows = t.rows() == frames && t.cols() == 3 && frames != 3;
    const Eigen::MatrixXd turned = by_rows ? Eigen::MatrixXd(t.transpose()) : t;
    for (Eigen::Index f = 0; f < frames; ++f)
      cameras[static_cast<std::size_t>(f)].translation = Eigen::Map<const Eigen::Vector3d>(turned.data() + 3 * f);
  }
  return cameras;
}

void read_visible(const Variables& file, const FileNames& names, Sequence& s, Notes* notes) {
  s.visible = Visible::Constant(s.frames(), s.points(), true);
  const std::string name = file.named(names.visible, {"V", "v", "visibility", "visible", "vis", "D", "MD"});
  if (name.empty()) {
    for (Eigen::Index f = 0; f < s.frames(); ++f)
      for (Eigen::Index p = 0; p < s.points(); ++p) s.visible(f, p) = s.tracks.block<2, 1>(2 * f, p).allFinite();
    return;
  }
  const Eigen::MatrixXd v = file.matrix(name);
  if (v.rows() != s.frames() || v.cols() != s.points())
    refuse(file.place(name), "is " + std::to_string(v.rows()) + " x " + std::to_string(v.cols()) +
                                 ", the tracks have " + std::to_string(s.frames()) + " frames x " +
                                 std::to_string(s.points()) + " points");
  if (((v.array() != 0) && (v.array() != 1)).any()) refuse(file.place(name), "has other values than 0 and 1");
  const bool marks_missing = names.visible.empty() && (name == "D" || name == "MD");
  if (marks_missing) note(notes, name + " is 1 where a point is missing");
  s.visible = v.array() == (marks_missing ? 0.0 : 1.0);
  for (Eigen::Index f = 0; f < s.frames(); ++f)
    for (Eigen::Index p = 0; p < s.points(); ++p)
      if (!s.visible(f, p)) s.tracks.block<2, 1>(2 * f, p).setConstant(missing);
}

void read_camera(const Variables& file, Sequence& s, Notes* notes) {
  if (file.find("K") != nullptr && file.find("K")->size == std::vector<std::size_t>{3, 3}) {
    const Eigen::MatrixXd k = file.matrix("K");
    if (!(k(0, 0) > 0 && k(1, 1) > 0)) refuse(file.place("K"), "has a focal length that is not positive");
    s.pinhole = Pinhole{k(0, 0), k(1, 1), k(0, 2), k(1, 2)};
    s.projection = Projection::perspective;
  }
  if (file.find("projection") == nullptr) return;
  const std::string projection = file.text("projection");
  if (projection != "orthographic" && projection != "perspective")
    refuse(file.place("projection"), "is \"" + projection + "\"", "orthographic and perspective are known");
  s.projection = projection == "perspective" ? Projection::perspective : Projection::orthographic;
  if (s.projection == Projection::orthographic) s.pinhole.reset();
  if (s.projection == Projection::perspective && !s.pinhole) note(notes, "the pinhole is not known");
}

// Tracks where a file has shapes alone: what an orthographic camera sees of them.
void tracks_of_truth(Sequence& s, Notes* notes) {
  const Shapes& truth = *s.truth;
  const Shapes seen = s.cameras.empty() ? truth : in_cameras(truth, s.cameras);
  s.tracks.resize(truth.rows() / 3 * 2, truth.cols());
  for (Eigen::Index f = 0; f < truth.rows() / 3; ++f) s.tracks.middleRows<2>(2 * f) = shape_of(seen, f).topRows<2>();
  note(notes, "no tracks: x and y of the truth stand for them");
}

void read_truth(const Variables& file, const FileNames& names, Sequence& s, Notes* notes) {
  std::string name = file.named(names.truth, {"S", "GT", "truth", "Pgth", "Q", "S_gt", "S3", "X"});
  if (name.empty()) return;
  bool by_frame = false;
  s.truth = file.shapes(name, &by_frame);
  if (by_frame) {
    s.truth_frame = ShapeFrame::camera;
    note(notes, name + " is an array by frames: taken as it stands in each frame's camera");
  }
  if (name == "Pgth") s.projection = Projection::perspective;
  if (file.find("frame") != nullptr)
    s.truth_frame = file.text("frame") == "camera" ? ShapeFrame::camera : ShapeFrame::object;
  if (names.truth.empty() && file.find("Shat") != nullptr && file.find("scale") != nullptr) {
    const double scale = file.number("scale");
    *s.truth *= scale;
    s.tracks *= scale;
    note(notes, "truth and tracks are times scale (" + std::to_string(scale) + "), the unit of Shat");
  }
}

Shapes depths_to_shapes(const Variables& file, const FileNames& names, const std::filesystem::path& path,
                        Notes* notes) {
  const io::MatVariable& all = *file.find("initialisations");
  if (all.kind != io::MatVariable::Kind::structure || all.elements.size() != 1)
    refuse(file.place("initialisations"), "is no single struct");
  std::string known;
  for (const auto& [key, v] : all.elements[0]) known += (known.empty() ? "" : ", ") + key;
  const auto method = names.shapes.empty() ? all.elements[0].begin() : all.elements[0].find(names.shapes);
  if (method == all.elements[0].end())
    refuse(file.place("initialisations"), "has no " + names.shapes, "it has " + known);
  const std::string at = file.place("initialisations." + method->first);
  if (method->second.elements.size() != 1 || !method->second.elements[0].contains("K") ||
      !method->second.elements[0].contains("initialDepth"))
    refuse(at, "has no K and initialDepth");
  const Eigen::MatrixXd k = matrix_of(method->second.elements[0].at("K"), at + ".K");
  if (k.rows() != 3 || k.cols() != 3 || std::abs(k.determinant()) < 1e-12) refuse(at + ".K", "is no camera matrix");
  const auto& depths = method->second.elements[0].at("initialDepth");
  std::string stem = path.stem().string();
  if (const auto cut = stem.find("_Initialisation"); cut != std::string::npos) stem.resize(cut);
  const std::filesystem::path beside =
      names.beside.empty() ? path.parent_path() / ("data_" + stem + ".mat") : names.beside;
  note(notes, "depths of " + method->first + " along the rays of the tracks in " + beside.filename().string());
  const Variables data(beside);
  const Tracks tracks = data.tracks(data.named(names.tracks, {"p", "W", "tracks"}));
  if (static_cast<Eigen::Index>(depths.cells.size()) != tracks.rows() / 2)
    refuse(at, "has depths of " + std::to_string(depths.cells.size()) + " frames, " + beside.string() + " has " +
                   std::to_string(tracks.rows() / 2));
  Shapes shapes(tracks.rows() / 2 * 3, tracks.cols());
  const Eigen::Matrix3d inverse = k.inverse();
  for (Eigen::Index f = 0; f < shapes.rows() / 3; ++f) {
    const Eigen::MatrixXd depth = matrix_of(depths.cells[static_cast<std::size_t>(f)], at + ".initialDepth");
    if (depth.size() != tracks.cols())
      refuse(at + ".initialDepth", "has " + std::to_string(depth.size()) + " depths in frame " + std::to_string(f) +
                                       " for " + std::to_string(tracks.cols()) + " points");
    Eigen::Matrix3Xd rays(3, tracks.cols());
    rays << tracks.middleRows<2>(2 * f), Eigen::RowVectorXd::Ones(tracks.cols());
    shape_of(shapes, f) = (inverse * rays) * Eigen::Map<const Eigen::VectorXd>(depth.data(), depth.size()).asDiagonal();
  }
  return shapes;
}

Reconstruction read_ply_frames(const std::filesystem::path& pattern, Notes* notes) {
  const std::vector<std::filesystem::path> files = files_in_order(pattern, ".ply");
  Reconstruction r;
  r.name = pattern.stem().string();
  for (std::size_t f = 0; f < files.size(); ++f) {
    const io::TriangleMesh mesh = io::read_ply(files[f]);
    const auto points = static_cast<Eigen::Index>(mesh.positions_m.size());
    if (f == 0) r.shapes.resize(3 * static_cast<Eigen::Index>(files.size()), points);
    if (points != r.shapes.cols())
      refuse(files[f].string(),
             "has " + std::to_string(points) + " vertices, " + files[0].filename().string() + " has " +
                 std::to_string(r.shapes.cols()),
             "every frame needs the same points in the same order");
    for (Eigen::Index p = 0; p < points; ++p) {
      const Vec3& v = mesh.positions_m[static_cast<std::size_t>(p)];
      shape_of(r.shapes, static_cast<Eigen::Index>(f)).col(p) = Eigen::Vector3d(v.x, v.y, v.z);
    }
  }
  note(notes, std::to_string(files.size()) + " frames: " + files.front().filename().string() + " to " +
                  files.back().filename().string());
  return r;
}

void read_rotations(const Variables& file, Reconstruction& r) {
  const std::string name = file.find("S") != nullptr && file.find("Shat") == nullptr
                               ? file.named("", {"R", "Rhat", "R_hat"})
                               : file.named("", {"Rhat", "R_hat"});
  if (name.empty()) return;
  for (const CameraFromObject& camera : cameras_of(file, name, r.frames()))
    r.rotations.push_back(camera.rotation.topRows<2>());
}

}  // namespace

Sequence read_sequence(const std::filesystem::path& path, const FileNames& names, Notes* notes) {
  const Variables file(path);
  Sequence s;
  s.name = path.stem().string();
  if (file.find("name") != nullptr) s.name = file.text("name");
  const std::string tracks = file.named(names.tracks, {"W", "tracks", "p", "W2D"});
  if (!tracks.empty()) s.tracks = file.tracks(tracks);
  read_truth(file, names, s, notes);
  if (tracks.empty() && !s.truth)
    refuse(path.string(), "has neither tracks (W) nor shapes (S)", "it has " + file.list() + "; name the variables");
  const Eigen::Index frames = tracks.empty() ? s.truth->rows() / 3 : s.frames();
  if (const std::string r = file.named("", {"R", "Rs"}); !r.empty()) s.cameras = cameras_of(file, r, frames);
  if (tracks.empty()) tracks_of_truth(s, notes);
  read_camera(file, s, notes);
  read_visible(file, names, s, notes);
  if (file.find("W_sigma") != nullptr) {
    s.sigma = file.matrix("W_sigma");
    if (s.sigma.rows() != s.frames() || s.sigma.cols() != s.points())
      refuse(file.place("W_sigma"), "is no number for every frame and point");
  }
  if (file.find("unit_m") != nullptr) s.unit_m = file.number("unit_m");
  if (s.unit_m < 0) refuse(file.place("unit_m"), "is negative");
  if (file.find("factors") != nullptr) s.factors = file.factors("factors");
  check(s, path.string());
  return s;
}

Reconstruction read_reconstruction(const std::filesystem::path& path, const FileNames& names, Notes* notes) {
  if (std::filesystem::is_directory(path) || path.extension() == ".ply") return read_ply_frames(path, notes);
  const Variables file(path);
  Reconstruction r;
  r.name = path.stem().string();
  bool by_frame = false;
  if (file.find("initialisations") != nullptr) {
    r.shapes = depths_to_shapes(file, names, path, notes);
    by_frame = true;
  } else {
    const std::string name =
        file.named(names.shapes, {"Shat", "S_hat", "shapes", "S", "X", "Xhat", "X_hat", "S3D", "Q", "points"});
    if (name.empty())
      refuse(path.string(), "has no shapes (S, Shat, X, ...)", "it has " + file.list() + "; name the variable");
    r.shapes = file.shapes(name, &by_frame);
    read_rotations(file, r);
  }
  r.frame = by_frame ? ShapeFrame::camera : ShapeFrame::object;
  if (file.find("frame") != nullptr) {
    const std::string frame = file.text("frame");
    if (frame != "object" && frame != "camera")
      refuse(file.place("frame"), "is \"" + frame + "\"", "object and camera are known");
    r.frame = frame == "camera" ? ShapeFrame::camera : ShapeFrame::object;
  } else {
    note(notes, std::string("shapes are taken as they stand in ") +
                    (by_frame ? "each frame's camera" : "one frame of reference"));
  }
  if (file.find("algorithm") != nullptr) r.name = file.text("algorithm");
  if (file.find("sequence") != nullptr) r.sequence = file.text("sequence");
  if (file.find("factors") != nullptr) r.factors = file.factors("factors");
  if (r.frames() < 2 || r.points() < 4)
    refuse(path.string(), "has " + std::to_string(r.frames()) + " frames of " + std::to_string(r.points()) +
                              " points, 2 of 4 are the least");
  return r;
}

namespace {

io::MatVariable structure_of(const Factors& factors) {
  io::MatVariable v;
  v.kind = io::MatVariable::Kind::structure;
  v.size = {1, 1};
  v.elements.emplace_back();
  for (const auto& [factor, level] : factors) v.elements[0][factor] = variable_of(level);
  return v;
}

// MATLAB's names of fields: letters, digits and _.
void check_factors(const Factors& factors, const std::string& place) {
  for (const auto& [factor, level] : factors) {
    bool sound = !factor.empty() && factor.size() < 32 && std::isalpha(static_cast<unsigned char>(factor[0])) != 0;
    for (const char c : factor) sound = sound && (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_');
    if (!sound)
      throw Error(Exit::data, place, "factor \"" + factor + "\" is no MATLAB name", "use letters, digits and _");
  }
}

void check_mat(const std::filesystem::path& file) {
  if (file.extension() != ".mat") throw Error(Exit::usage, file.string(), "is written as MATLAB file", "call it .mat");
}

}  // namespace

void write_sequence(const Sequence& s, const std::filesystem::path& file, const std::string& made_with) {
  check_mat(file);
  check(s, s.name);
  check_factors(s.factors, s.name);
  io::MatFile out;
  out["W"] = variable_of(s.tracks);
  out["V"] = variable_of(s.visible.cast<double>().matrix());
  out["V"].kind = io::MatVariable::Kind::logical;
  if (s.sigma.size() > 0) out["W_sigma"] = variable_of(s.sigma);
  if (s.truth) out["S"] = variable_of(*s.truth);
  out["frame"] = variable_of(std::string(s.truth_frame == ShapeFrame::camera ? "camera" : "object"));
  out["projection"] =
      variable_of(std::string(s.projection == Projection::perspective ? "perspective" : "orthographic"));
  if (s.pinhole) {
    Eigen::Matrix3d k;
    k << s.pinhole->fx_px, 0, s.pinhole->cx_px, 0, s.pinhole->fy_px, s.pinhole->cy_px, 0, 0, 1;
    out["K"] = variable_of(Eigen::MatrixXd(k));
  }
  if (!s.cameras.empty()) {
    Eigen::MatrixXd r(2 * s.frames(), 3), t(3 * s.frames(), 1);
    for (Eigen::Index f = 0; f < s.frames(); ++f) {
      r.middleRows<2>(2 * f) = s.cameras[static_cast<std::size_t>(f)].rotation.topRows<2>();
      t.middleRows<3>(3 * f) = s.cameras[static_cast<std::size_t>(f)].translation;
    }
    out["R"] = variable_of(r);
    out["T"] = variable_of(t);
  }
  if (s.unit_m > 0) out["unit_m"] = variable_of(Eigen::MatrixXd::Constant(1, 1, s.unit_m));
  if (!s.name.empty()) out["name"] = variable_of(s.name);
  if (!s.factors.empty()) out["factors"] = structure_of(s.factors);
  if (!made_with.empty()) out["made_with"] = variable_of(made_with);
  io::write_mat(out, file);
}

std::string made_with_of(const std::filesystem::path& file) {
  const io::MatFile there = io::read_mat(file);
  const auto said = there.find("made_with");
  return said == there.end() ? "" : said->second.text;
}

void write_reconstruction(const Reconstruction& r, const std::filesystem::path& file, const io::MatFile& besides) {
  check_mat(file);
  check_factors(r.factors, r.name);
  io::MatFile out = besides;
  out["S"] = variable_of(r.shapes);
  out["frame"] = variable_of(std::string(r.frame == ShapeFrame::camera ? "camera" : "object"));
  if (!r.rotations.empty()) {
    Eigen::MatrixXd rows(2 * r.frames(), 3);
    for (Eigen::Index f = 0; f < r.frames(); ++f) rows.middleRows<2>(2 * f) = r.rotations[static_cast<std::size_t>(f)];
    out["R"] = variable_of(rows);
  }
  if (!r.name.empty()) out["algorithm"] = variable_of(r.name);
  if (!r.sequence.empty()) out["sequence"] = variable_of(r.sequence);
  if (!r.factors.empty()) out["factors"] = structure_of(r.factors);
  io::write_mat(out, file);
}

}  // namespace gonio::nrsfm
