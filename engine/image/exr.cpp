#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <thread>

#include "image/picture.h"
#include "image/whole_file.h"
#include "scene/error.h"

namespace alabaster {
namespace {

// Half a second of deflate at the library's own level buys 3 % of size on float pictures; level 1 is what a frame can
// wait for.
constexpr int deflate_level = 1;
constexpr float largest_half = 65504.0f;

int codec_threads() {
  static const int threads = [] {
    int n = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 8u));
    Imf::setGlobalThreadCount(n);
    return n;
  }();
  return threads;
}

bool fits_half(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::abs(v) <= largest_half; });
}

Imf::Slice slice_of(const Picture& picture, const std::vector<float>& values, Imath::V2i origin) {
  // OpenEXR addresses pixels by absolute data-window coordinates and only reads from the slices of an output file.
  char* base = reinterpret_cast<char*>(const_cast<float*>(values.data()));
  const auto row = static_cast<std::ptrdiff_t>(picture.width) * static_cast<std::ptrdiff_t>(sizeof(float));
  base -= origin.y * row + origin.x * static_cast<std::ptrdiff_t>(sizeof(float));
  return Imf::Slice(Imf::FLOAT, base, sizeof(float), static_cast<std::size_t>(row));
}

Attribute attribute_of(const Imf::Attribute& a, bool& known) {
  known = true;
  if (auto* s = dynamic_cast<const Imf::StringAttribute*>(&a)) return s->value();
  if (auto* d = dynamic_cast<const Imf::DoubleAttribute*>(&a)) return d->value();
  if (auto* f = dynamic_cast<const Imf::FloatAttribute*>(&a)) return static_cast<double>(f->value());
  if (auto* i = dynamic_cast<const Imf::IntAttribute*>(&a)) return static_cast<double>(i->value());
  known = false;
  return 0.0;
}

// Attributes that every EXR header has and the library itself keeps.
bool is_structural(const std::string& name) {
  static const std::set<std::string> names{"pixelAspectRatio", "screenWindowWidth", "name", "type",
                                           "version",          "chunkCount",        "view", "dwaCompressionLevel"};
  return names.count(name) != 0;
}

void check(const Picture& picture, const std::string& path) {
  const auto pixels = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
  if (picture.width <= 0 || picture.height <= 0 || picture.channels.empty())
    throw UserError(path + ": the picture is empty; nothing to write");
  for (const auto& [name, values] : picture.channels)
    if (values.size() != pixels) throw std::logic_error("channel " + name + " does not have width * height values");
}

}  // namespace

std::vector<float>& Picture::plane(const std::string& name) {
  std::vector<float>& values = channels[name];
  values.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.0f);
  return values;
}

void write_exr(const Picture& picture, const std::string& path, bool half) {
  check(picture, path);
  Imf::Header header(picture.width, picture.height);
  // Of the lossless codecs PIZ was the smallest on float layers and none with a like size was faster: 640x480 with 25
  // layers took 0.18 s, 10 MB (ZIP 0.18 s, 11 MB; ZIP level 4 0.20 s).
  header.compression() = Imf::PIZ_COMPRESSION;
  for (const auto& [name, value] : picture.attributes) {
    if (is_structural(name)) continue;
    if (const auto* number = std::get_if<double>(&value))
      header.insert(name, Imf::DoubleAttribute(*number));
    else
      header.insert(name, Imf::StringAttribute(std::get<std::string>(value)));
  }
  std::vector<std::vector<Imath::half>> halves;
  halves.reserve(picture.channels.size());
  Imf::FrameBuffer pixels;
  for (const auto& [name, values] : picture.channels) {
    if (half && fits_half(values)) {
      halves.emplace_back(values.begin(), values.end());
      header.channels().insert(name, Imf::Channel(Imf::HALF));
      pixels.insert(name, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(halves.back().data()), sizeof(Imath::half),
                                     sizeof(Imath::half) * static_cast<std::size_t>(picture.width)));
    } else {
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      pixels.insert(name, slice_of(picture, values, {0, 0}));
    }
  }
  write_whole_file(path, [&](const std::string& temporary) {
    Imf::OutputFile file(temporary.c_str(), header, codec_threads());
    file.setFrameBuffer(pixels);
    file.writePixels(picture.height);
  });
}

Picture read_exr(const std::string& path) {
  try {
    Imf::InputFile file(path.c_str(), codec_threads());
    const Imf::Header& header = file.header();
    const Imath::Box2i window = header.dataWindow();
    Picture picture;
    picture.width = window.max.x - window.min.x + 1;
    picture.height = window.max.y - window.min.y + 1;
    Imf::FrameBuffer pixels;
    for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
      if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1)
        throw UserError(path + ": channel " + channel.name() + " is subsampled; convert the file to plain R, G, B");
      pixels.insert(channel.name(), slice_of(picture, picture.plane(channel.name()), window.min));
    }
    for (auto entry = header.begin(); entry != header.end(); ++entry) {
      bool known = false;
      Attribute value = attribute_of(entry.attribute(), known);
      if (known && !is_structural(entry.name())) picture.attributes[entry.name()] = value;
    }
    file.setFrameBuffer(pixels);
    file.readPixels(window.min.y, window.max.y);
    return picture;
  } catch (const UserError&) {
    throw;
  } catch (const std::exception& failure) {
    throw UserError(path + ": cannot be read as an EXR picture (" + failure.what() +
                    "); check the name and that the file is complete");
  }
}

}  // namespace alabaster
