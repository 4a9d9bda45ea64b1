// See calibration.h.
#include "colour/calibration.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "colour/correction_fit.h"
#include "geom/mat3_inverse.h"
#include "stats/intervals.h"

namespace gonio::colour {
namespace {

constexpr double rare = 1e-3, least_evenness = 0.2;

bool taken(Take take, double chance) {
  return take == Take::always || (take == Take::automatic && chance < rare);
}

class Calibrating {
 public:
  Calibrating(const Chart& chart, std::span<const PatchReading> readings, const CalibrationRequest& request,
              const std::string& place)
      : chart_(chart), readings_(readings), request_(request), place_(place) {
    for (std::size_t p = 0; p < readings.size(); ++p)
      if (readings[p].left_out.empty()) counts_.push_back(p);
    white_ = white_of(chart, readings, place);
    choose_light();
  }

  Calibration best() {
    Calibration result;
    result.white = white_, result.found = found_, result.taken = light_;
    std::vector<Attempt> attempts;
    for (const Model model : candidates()) {
      Tried tried{model, 0, 0, {}};
      try {
        attempts.push_back(attempt(model));
        tried.fitted = spread(attempts.back().fitted).mean, tried.held_out = spread(attempts.back().held_out).mean;
      } catch (const Error& error) {
        if (request_.model || error.code() != Exit::data) throw;
        tried.refused = error.problem();
      }
      result.tried.push_back(std::move(tried));
    }
    if (attempts.empty())
      throw Error(Exit::data, place_, "shows too few patches for any model", "show more of the chart's patches");
    fill(result, simplest(attempts));
    return result;
  }

 private:
  struct Attempt {
    Correction whole;
    std::vector<Correction> folds;         // one for each patch that counts
    std::vector<double> fitted, held_out;  // of patches that count
  };

  void choose_light() {
    LightRequest request{request_.offset != Take::never, request_.gradient != Take::never, false};
    found_ = chart_light(chart_, readings_, white_, request);
    if (request.gradient) {
      request.curve = true;
      const ChartLight curved = chart_light(chart_, readings_, white_, request);
      if (curved.curve_chance < rare) found_ = curved, chosen_.curve = true;
    }
    chosen_.offset = taken(request_.offset, found_.offset_chance);
    chosen_.gradient = chosen_.curve || taken(request_.gradient, found_.gradient_chance);
    light_ = chart_light(chart_, readings_, white_, chosen_);
    if (!(light_.evenness() > least_evenness))
      throw Error(Exit::data, place_,
                  format("light falls to %.0f %% of its most within the chart, limit %.0f %%",
                         100 * std::max(0.0, light_.evenness()), 100 * least_evenness),
                  "light it evenly");
    white_ = white_of(chart_, evened(light_), place_);
    for (std::size_t i = 0; i < counts_.size(); ++i)
      folds_.push_back(chart_light(chart_, readings_, white_, chosen_, counts_[i]));
  }

  std::vector<PatchReading> evened(const ChartLight& light) const {
    std::vector<PatchReading> out(readings_.begin(), readings_.end());
    for (std::size_t p = 0; p < out.size(); ++p) out[p].rgb = light.evened(out[p].rgb, chart_.patches[p].centre);
    return out;
  }

  std::vector<Model> candidates() const {
    if (request_.model) return {*request_.model};
    std::vector<Model> all;
    for (int m = 0; m < models; ++m)
      if (keeps_exposure(static_cast<Model>(m))) all.push_back(static_cast<Model>(m));
    return all;
  }

  Correction fit(Model model, const ChartLight& light, std::optional<std::size_t> without) const {
    std::vector<Sample> samples;
    for (const std::size_t p : counts_) {
      if (p == without) continue;
      const double over = 1 / light.relative_light(chart_.patches[p].centre);
      Mat3 covariance = readings_[p].covariance;
      for (double& c : covariance.m) c *= over * over;
      samples.push_back({light.evened(readings_[p].rgb, chart_.patches[p].centre), covariance, chart_.patches[p].lab});
    }
    return fit_correction(samples, {model, request_.target, white_, request_.refine}, place_);
  }
  double difference(const Correction& correction, const ChartLight& light, std::size_t patch) const {
    const Patch& p = chart_.patches[patch];
    return optics::ciede2000(p.lab, correction.lab(light.evened(readings_[patch].rgb, p.centre)));
  }

  Attempt attempt(Model model) const {
    Attempt result;
    result.whole = fit(model, light_, {});
    result.folds.assign(counts_.size(), result.whole);
    parallel_for(0, counts_.size(), [&](std::size_t i) { result.folds[i] = fit(model, folds_[i], counts_[i]); });
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      result.fitted.push_back(difference(result.whole, light_, counts_[i]));
      result.held_out.push_back(difference(result.folds[i], folds_[i], counts_[i]));
    }
    return result;
  }

  // Of the fewest terms among those that predict no worse than the best: by less than the standard error of the
  // difference, patch by patch (Breiman et al. 1984 for the rule).
  const Attempt& simplest(const std::vector<Attempt>& attempts) const {
    const auto least =
        std::ranges::min_element(attempts, {}, [this](const Attempt& a) { return spread(a.held_out).mean; });
    const Attempt* best = &*least;
    for (const Attempt& attempt : attempts) {
      std::vector<double> behind(attempt.held_out.size());
      for (std::size_t i = 0; i < behind.size(); ++i) behind[i] = attempt.held_out[i] - least->held_out[i];
      const bool alike = !(stats::mean(behind) > stats::standard_error(behind));
      const auto terms = [](const Attempt& a) { return terms_of(a.whole.model()).size(); };
      const auto rank = [&](const Attempt& a) { return std::pair{terms(a), spread(a.held_out).mean}; };
      if (alike && rank(attempt) < rank(*best)) best = &attempt;
    }
    return *best;
  }

  Spread spread(const std::vector<double>& differences) const {
    Spread s;
    const auto count = static_cast<double>(differences.size());
    for (std::size_t i = 0; i < differences.size(); ++i) {
      s.mean += differences[i] / count;
      if (differences[i] > s.most) s.most = differences[i], s.worst = counts_[i];
    }
    for (const double d : differences) s.deviation += (d - s.mean) * (d - s.mean) / std::max(1.0, count - 1);
    s.deviation = std::sqrt(s.deviation);
    return s;
  }

  // (n - 1) / n times the sum of squares about the mean of the fits without one patch (Efron & Stein 1981).
  static std::vector<std::vector<double>> jackknife(const std::vector<Correction>& folds) {
    std::vector<std::vector<double>> fits;
    for (const Correction& fold : folds) {
      fits.emplace_back();
      for (const auto& row : fold.matrix()) fits.back().insert(fits.back().end(), row.begin(), row.end());
    }
    const std::size_t size = fits[0].size();
    const auto count = static_cast<double>(fits.size());
    std::vector<double> mean(size);
    for (const auto& fit : fits)
      for (std::size_t k = 0; k < size; ++k) mean[k] += fit[k] / count;
    std::vector<std::vector<double>> covariance(size, std::vector<double>(size));
    for (const auto& fit : fits)
      for (std::size_t i = 0; i < size; ++i)
        for (std::size_t j = 0; j < size; ++j)
          covariance[i][j] += (count - 1) / count * (fit[i] - mean[i]) * (fit[j] - mean[j]);
    return covariance;
  }

  void fill(Calibration& result, const Attempt& best) const {
    result.correction = best.whole;
    result.fitted = spread(best.fitted), result.held_out = spread(best.held_out);
    result.covariance = jackknife(best.folds);
    std::vector<Rgb> pixels;
    for (std::size_t p = 0; p < readings_.size(); ++p)
      result.patches.push_back({light_.evened(readings_[p].rgb, chart_.patches[p].centre), {}, {}});
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      PatchOutcome& patch = result.patches[counts_[i]];
      patch.fitted = best.fitted[i], patch.held_out = best.held_out[i];
      pixels.push_back(patch.evened);
    }
    result.exposure_de00 = exposure_change(best.whole, pixels);
    result.noise_gain = noise_gain(best.whole, pixels);
  }

  const Chart& chart_;
  std::span<const PatchReading> readings_;
  const CalibrationRequest& request_;
  const std::string& place_;
  std::vector<std::size_t> counts_;  // patches
  Rgb white_;
  LightRequest chosen_{false, false, false};
  ChartLight found_, light_;
  std::vector<ChartLight> folds_;
};

}  // namespace

Calibration calibrate(const Chart& chart, std::span<const PatchReading> readings, const CalibrationRequest& request,
                      const std::string& place) {
  return Calibrating(chart, readings, request, place).best();
}

double exposure_change(const Correction& correction, std::span<const Rgb> pixels) {
  const Mat3 xyz = inverse(from_xyz_d50(correction.target()));
  double most = 0;
  for (const double factor : {0.1, 0.3, 3.0, 10.0}) {
    double mean = 0;
    for (const Rgb pixel : pixels)
      mean += optics::ciede2000(correction.lab(pixel),
                                optics::lab_from_xyz(xyz * correction(pixel * factor) / factor, optics::white_d50)) /
              static_cast<double>(pixels.size());
    most = std::max(most, mean);
  }
  return most;
}

double noise_gain(const Correction& correction, std::span<const Rgb> pixels) {
  double sum = 0;
  for (const Rgb pixel : pixels) {
    const Mat3 slopes = correction.slopes(pixel);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) sum += std::pow(slopes(i, j) * correction.white()[j], 2);
  }
  return std::sqrt(sum / (3 * static_cast<double>(pixels.size())));
}

}  // namespace gonio::colour
