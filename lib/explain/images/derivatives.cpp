// See derivatives.h.
#include "explain/images/derivatives.h"

namespace gonio::explain::images {

Touched touched_by(const std::vector<Place>& places, const SceneState& state, const std::vector<Use>& uses) {
  Touched t;
  const bool shaded =
      std::any_of(uses.begin(), uses.end(), [&](const Use& use) { return use.term->shade && !use.neutral(state); });
  const auto at_least = [&](Reach reach) { t.reach = std::max(t.reach, reach); };
  for (const Place& p : places) switch (p.kind) {
      case Place::Kind::surface: {
        const surface::Model& model = *state.surfaces[p.target].model;
        at_least(Reach::compose);
        if (has_parameter(model, "albedo") && p.parameter == parameter_index(model, "albedo")) {
          // Terms there may depend on it; facets do not, but where their base is out of proportion to it.
          const bool proportional = model.proportional_to_albedo(state.surfaces[p.target].values);
          at_least(shaded || !proportional ? Reach::surfaces : Reach::compose);
          if (!proportional) t.surfaces.push_back(static_cast<std::uint32_t>(p.target));
          break;
        }
        at_least(Reach::surfaces);
        t.surfaces.push_back(static_cast<std::uint32_t>(p.target));
        break;
      }
      case Place::Kind::intensity:
      case Place::Kind::gain: at_least(Reach::compose); break;
      case Place::Kind::amount: {
        const Use& use = uses[p.target];
        at_least(use.term->reach);
        if (use.term->reach != Reach::surfaces) break;
        for (const std::size_t s : use.targets) t.surfaces.push_back(static_cast<std::uint32_t>(s));
        break;
      }
    }
  return t;
}

Derivatives::Derivatives(const ImageModel& model, SceneState centre, std::size_t image,
                         std::span<const std::uint32_t> picked)
    : model_(model), centre_(std::move(centre)), image_(image), picked_(picked), composed_(3 * picked.size()) {
  const SceneState now = model_.edited(centre_, image_);
  shaded_ = model_.shaded(now, image_, picked_);
  model_.compose(now, image_, picked_, shaded_->whole(), composed_);
  added_ = composed_;
  model_.add_terms(now, image_, picked_, added_, &additions_);
  for (const Use& use : model_.uses())
    if (use.term->record && !use.neutral(now)) recorded_ = true, pointwise_ = pointwise_ && use.term->pointwise;
  if (std::ranges::any_of(model_.uses(), [&](const Use& use) { return use.term->anew && !use.neutral(now); }))
    find_passing(now);
  if (recorded_ && pointwise_) find_gains(now);
}

void Derivatives::at(const SceneState& raw, const Touched& touched, std::span<double> out) const {
  const SceneState now = model_.edited(raw, image_);
  if (touched.reach == Reach::record) {
    std::copy(added_.begin(), added_.end(), out.begin());
  } else if (touched.reach == Reach::add) {
    std::copy(composed_.begin(), composed_.end(), out.begin());
    model_.add_terms(now, image_, picked_, out);
  } else {
    composed(now, touched, out);
    model_.add_terms_again(now, image_, picked_, additions_, out);
  }
  if (touched.reach == Reach::record || !pointwise_) return model_.record_terms(now, image_, picked_, out);
  if (recorded_)
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = values_[i] + gain_[i] * (out[i] - added_[i]);
}

void Derivatives::slopes(const Use& use, std::span<const std::size_t> numbers, std::span<double> columns) const {
  const SceneState now = model_.edited(centre_, image_);
  const Recording& image = model_.recordings().images[image_];
  use.term->slopes(use, {image_, image, model_.cache(image.view), picked_, now, model_}, numbers, columns);
  const std::size_t rows = composed_.size();
  if (!passing_.empty())
    for (std::size_t i = 0; i < columns.size(); ++i) columns[i] *= passing_[i % rows];
  if (!recorded_) return;
  if (pointwise_) {
    for (std::size_t i = 0; i < columns.size(); ++i) columns[i] *= gain_[i % rows];
    return;
  }
  std::vector<double> above(rows), below(rows);
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const std::span<double> column = columns.subspan(k * rows, rows);
    const double step = 1e-4 * use.numbers[numbers[k]].upper;
    for (std::size_t i = 0; i < rows; ++i)
      above[i] = added_[i] + step * column[i], below[i] = added_[i] - step * column[i];
    model_.record_terms(now, image_, picked_, above);
    model_.record_terms(now, image_, picked_, below);
    for (std::size_t i = 0; i < rows; ++i) column[i] = (above[i] - below[i]) / (2 * step);
  }
}

// What a small change of each value becomes where `made` makes values of values, each of its own alone.
template <class Made>
std::vector<double> gains_of(const std::vector<double>& values, const Made& made) {
  constexpr double small = 1e-4;
  double largest = 0;
  for (const double v : values) largest = std::max(largest, std::abs(v));
  const double step = small * largest;
  std::vector<double> above = values, below = values;
  for (double& v : above) v += step;
  for (double& v : below) v -= step;
  made(above), made(below);
  for (std::size_t i = 0; i < above.size(); ++i) above[i] = step > 0 ? (above[i] - below[i]) / (2 * step) : 0;
  return above;
}

// What terms that are added anew leave of radiance that others add.
void Derivatives::find_passing(const SceneState& now) {
  ImageModel::Additions none = additions_;
  for (auto& [place, noted] : none) noted = {composed_, composed_};
  passing_ = gains_of(composed_, [&](std::span<double> v) { model_.add_terms_again(now, image_, picked_, none, v); });
}

void Derivatives::find_gains(const SceneState& now) {
  values_ = added_;
  model_.record_terms(now, image_, picked_, values_);
  gain_ = gains_of(added_, [&](std::span<double> v) { model_.record_terms(now, image_, picked_, v); });
}

void Derivatives::composed(const SceneState& now, const Touched& touched, std::span<double> out) const {
  if (touched.reach == Reach::compose) return model_.compose(now, image_, picked_, shaded_->whole(), out);
  Shading shading = touched.reach == Reach::all ? model_.shade(now, image_, picked_) : shaded_->plain;
  if (touched.reach == Reach::surfaces)
    for (const std::uint32_t s : touched.surfaces) model_.shade_again(now, image_, picked_, s, shading);
  model_.shade_terms(now, image_, picked_, shading);
  model_.compose(now, image_, picked_, shading, out);
}

}  // namespace gonio::explain::images
