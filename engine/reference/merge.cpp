#include <cmath>
#include <set>

#include "reference/reference.h"
#include "scene/error.h"

namespace alabaster {
namespace {

const Attribute& attribute_of(const Picture& part, const std::string& file, const std::string& name) {
  auto found = part.attributes.find(name);
  if (found == part.attributes.end())
    throw UserError(file + ": has no attribute " + name + ": it is not a picture of the reference; leave it out");
  return found->second;
}

std::string text_of(const Picture& part, const std::string& file, const std::string& name) {
  const auto* text = std::get_if<std::string>(&attribute_of(part, file, name));
  if (!text) throw UserError(file + ": attribute " + name + " is not a text; render the part again");
  return *text;
}

double samples_of(const Picture& part, const std::string& file) {
  const auto* number = std::get_if<double>(&attribute_of(part, file, "samplesPerPixel"));
  if (!number || !(*number > 0))
    throw UserError(file + ": attribute samplesPerPixel is not a positive number; render the part again");
  return *number;
}

// "3+4" -> 3, 4: a merged picture lists the seeds of its parts.
std::vector<std::string> seeds_of(const std::string& list) {
  std::vector<std::string> seeds(1);
  for (char c : list) {
    if (c == '+')
      seeds.emplace_back();
    else
      seeds.back() += c;
  }
  return seeds;
}

bool is_variance(const std::string& channel) { return channel.rfind("variance.", 0) == 0; }
bool is_first_surface(const std::string& channel) { return channel == "Z" || channel.rfind("N.", 0) == 0; }

void check(const std::vector<Picture>& parts, const std::vector<std::string>& names) {
  std::set<std::string> seeds;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const bool same_channels = parts[k].channels.size() == parts[0].channels.size() &&
                               std::equal(parts[k].channels.begin(), parts[k].channels.end(), parts[0].channels.begin(),
                                          [](const auto& a, const auto& b) { return a.first == b.first; });
    if (parts[k].width != parts[0].width || parts[k].height != parts[0].height || !same_channels ||
        text_of(parts[k], names[k], "sceneFingerprint") != text_of(parts[0], names[0], "sceneFingerprint"))
      throw UserError(names[k] + ": is not a part of the same picture as " + names[0] +
                      "; scene, camera, size and components must agree");
    for (const std::string& seed : seeds_of(text_of(parts[k], names[k], "seed")))
      if (!seeds.insert(seed).second)
        throw UserError(names[k] + ": seed " + seed +
                        " is in another part already; render every part with its own --seed");
  }
}

// Of what a variance is of: "variance.R" -> R; "variance.single.R" -> single.R; "variance.subsurface.R" -> the sum less
// surface.
double mean_of(const Picture& part, const std::string& variance, std::size_t i) {
  const std::string of = variance.substr(std::string("variance.").size()), c(1, variance.back());
  if (of != "subsurface." + c) return static_cast<double>(part.channels.at(of)[i]);
  const auto surface = part.channels.find("surface." + c);
  return static_cast<double>(part.channels.at(c)[i]) -
         (surface == part.channels.end() ? 0.0 : static_cast<double>(surface->second[i]));
}

}  // namespace

Picture merge(const std::vector<Picture>& parts, const std::vector<std::string>& names) {
  if (parts.empty()) throw UserError("merge: no parts given; name at least one EXR file of the reference");
  check(parts, names);
  Picture whole = parts[0];
  double samples = 0;
  std::vector<double> n;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    n.push_back(samples_of(parts[k], names[k]));
    samples += n.back();
  }
  for (auto& [channel, values] : whole.channels) {
    if (is_first_surface(channel)) continue;  // of the pixel's centre: the same in every part
    for (std::size_t i = 0; i < values.size(); ++i) {
      double mean = 0, squares = 0;  // `squares`: sum of squared deviations from the mean of all samples
      for (std::size_t k = 0; k < parts.size(); ++k)
        mean += n[k] / samples *
                (is_variance(channel) ? mean_of(parts[k], channel, i)
                                      : static_cast<double>(parts[k].channels.at(channel)[i]));
      if (is_variance(channel)) {
        for (std::size_t k = 0; k < parts.size(); ++k) {
          const double off = mean_of(parts[k], channel, i) - mean;
          squares += static_cast<double>(parts[k].channels.at(channel)[i]) * n[k] * (n[k] - 1) + n[k] * off * off;
        }
        values[i] = static_cast<float>(samples > 1 ? squares / (samples * (samples - 1)) : 0.0);
      } else {
        values[i] = static_cast<float>(mean);
      }
    }
  }
  std::string seeds;
  double seconds = 0, capped = 0, leaks = 0, events = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    seeds += (k ? "+" : "") + text_of(parts[k], names[k], "seed");
    seconds += std::get<double>(attribute_of(parts[k], names[k], "seconds"));
    capped += std::get<double>(attribute_of(parts[k], names[k], "cappedPaths"));
    leaks += std::get<double>(attribute_of(parts[k], names[k], "leakedPaths"));
    events += n[k] / samples * std::get<double>(attribute_of(parts[k], names[k], "eventsPerSample"));
  }
  whole.attributes["samplesPerPixel"] = samples;
  whole.attributes["seed"] = seeds;
  whole.attributes["seconds"] = seconds;
  whole.attributes["cappedPaths"] = capped;
  whole.attributes["leakedPaths"] = leaks;
  whole.attributes["eventsPerSample"] = events;
  whole.attributes.erase("noise");
  return whole;
}

}  // namespace alabaster
