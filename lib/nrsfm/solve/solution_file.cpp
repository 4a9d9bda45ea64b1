// See solution_file.h. The struct `solution` of the .mat: values, iterations, converged, reprojection_rms, notes,
// made_from (the identity).
#include "nrsfm/solve/solution_file.h"

#include <cstring>

#include "base/error.h"
#include "base/hash.h"
#include "base/text.h"
#include "nrsfm/files.h"
#include "nrsfm/variables.h"

namespace gonio::nrsfm {
namespace {

using io::MatVariable;

std::string bytes_of(const Eigen::MatrixXd& m) {
  std::string bytes(static_cast<std::size_t>(m.size()) * sizeof(double), '\0');
  if (!bytes.empty()) std::memcpy(bytes.data(), m.data(), bytes.size());
  return bytes;
}

MatVariable number(double value) {
  return variable_of(Eigen::MatrixXd::Constant(1, 1, value));
}

MatVariable structure() {
  MatVariable v;
  v.kind = MatVariable::Kind::structure;
  v.size = {1, 1};
  v.elements.emplace_back();
  return v;
}

MatVariable texts(const std::vector<std::string>& lines) {
  MatVariable v;
  v.kind = MatVariable::Kind::cells;
  v.size = {1, lines.size()};
  for (const std::string& line : lines) v.cells.push_back(variable_of(line));
  return v;
}

using Fields = std::map<std::string, MatVariable>;

const MatVariable& at(const Fields& fields, const std::string& name, const std::string& place) {
  const auto found = fields.find(name);
  if (found == fields.end()) throw Error(Exit::data, place + "#solution", "has no " + name);
  return found->second;
}

double number_at(const Fields& fields, const std::string& name, const std::string& place) {
  const MatVariable& v = at(fields, name, place);
  if (v.values.size() != 1) throw Error(Exit::data, place + "#solution." + name, "is no number");
  return v.values.front();
}

}  // namespace

std::string identity_of(const Solver& solver, const Sequence& sequence, const SolverOptions& options) {
  std::string text = GONIO_VERSION "\n" + solver.info().id + "\n";
  for (const auto& [name, value] : options.values) text += name + "=" + shortest_text(value) + "\n";
  text += std::to_string(options.most_iterations) + " " + std::to_string(options.seed) + "\n";
  text += std::to_string(sequence.frames()) + " x " + std::to_string(sequence.points()) + "\n";
  text += sequence.projection == Projection::perspective ? "perspective" : "orthographic";
  if (const auto& k = sequence.pinhole) text += bytes_of(Eigen::Vector4d(k->fx_px, k->fy_px, k->cx_px, k->cy_px));
  const Eigen::MatrixXd visible = sequence.visible.cast<double>().matrix();
  Tracks seen = sequence.tracks;  // what stands where nothing is visible does not count
  for (Eigen::Index f = 0; f < sequence.frames(); ++f)
    for (Eigen::Index p = 0; p < sequence.points(); ++p)
      if (!sequence.visible(f, p)) seen.block<2, 1>(2 * f, p).setZero();
  return sha256(text + bytes_of(visible) + bytes_of(seen));
}

void write_solution(const Solution& solution, const std::string& identity, const std::filesystem::path& file) {
  MatVariable said = structure(), values = structure();
  for (const auto& [name, value] : solution.values) values.elements[0][name] = number(value);
  Fields& fields = said.elements[0];
  if (!solution.values.empty()) fields["values"] = std::move(values);
  fields["iterations"] = number(solution.iterations);
  fields["converged"] = number(solution.converged);
  fields["reprojection_rms"] = number(solution.reprojection_rms);
  if (!solution.notes.empty()) fields["notes"] = texts(solution.notes);
  fields["made_from"] = variable_of(identity);
  write_reconstruction(solution.reconstruction, file, {{"solution", std::move(said)}});
}

std::optional<Solution> read_solution(const std::filesystem::path& file, const std::string& identity) {
  const std::string place = file.string();
  const Variables variables(file);
  const MatVariable* said = variables.find("solution");
  if (said == nullptr || said->elements.size() != 1) return {};
  const Fields& fields = said->elements.front();
  if (at(fields, "made_from", place).text != identity) return {};
  Solution solution;
  solution.reconstruction = read_reconstruction(file);
  if (const auto values = fields.find("values"); values != fields.end() && values->second.elements.size() == 1)
    for (const auto& [name, value] : values->second.elements.front())
      solution.values[name] = number_at(values->second.elements.front(), name, place);
  solution.iterations = static_cast<int>(number_at(fields, "iterations", place));
  solution.converged = number_at(fields, "converged", place) != 0;
  solution.reprojection_rms = number_at(fields, "reprojection_rms", place);
  if (const auto notes = fields.find("notes"); notes != fields.end())
    for (const MatVariable& line : notes->second.cells) solution.notes.push_back(line.text);
  return solution;
}

}  // namespace gonio::nrsfm
