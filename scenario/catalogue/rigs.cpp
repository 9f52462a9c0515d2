#include "scenario/catalogue/rigs.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "experimental_site/geometry/linear_geometry.hpp"
#include "experimental_site/geometry/rigid_beam.hpp"
#include "experimental_site/geometry/transformed_rig.hpp"
#include "experimental_site/rigs/replay_rig.hpp"
#include "experimental_site/rigs/simulated_rig.hpp"
#include "experimental_site/rigs/udp_port.hpp"
#include "experimental_site/rigs/udp_rig.hpp"
#include "plant/specimens/elastic_specimen.hpp"
#include "plant/transfer_systems/delay.hpp"
#include "scenario/catalogue/part.hpp"
#include "scenario/catalogue/simulated_rig.hpp"
#include "scenario/measurement_file.hpp"
#include "scenario/named_file.hpp"

namespace hybridtest {
namespace {
using config::Section;

RigReading read_udp_rig(Section& section, int actuators) {
  UdpPort::Address address;
  address.host = section.text("host");
  address.port = static_cast<std::uint16_t>(section.integer("port", 1, 65535));
  address.local_port = static_cast<std::uint16_t>(section.integer("local_port", 0, 65535, 0));

  UdpRig::Settings settings;
  settings.name = address.host + ":" + std::to_string(address.port);
  settings.actuators = actuators;
  settings.follows_datagrams = section.choice("pace", {"clock", "datagrams"}, "clock") == 1;
  settings.watchdog = from_seconds(section.number("watchdog_s", {.low = 1e-4, .high = 10.0}, 0.05));
  const double reply_wait_s = settings.follows_datagrams ? 0.1 : 0.0;
  settings.reply_wait = from_seconds(section.number("reply_wait_s", {.low = 0.0, .high = 1.0}, reply_wait_s));
  settings.connect_timeout = from_seconds(section.number("connect_timeout_s", {.low = 0.1, .high = 3600.0}, 5.0));

  RigReading reading;
  reading.transfer_delay_s.assign(static_cast<std::size_t>(actuators),
                                  section.number("transfer_delay_s", {.low = 0.0, .high = 10.0}, 0.0));
  reading.silence_s_max = to_seconds(settings.watchdog);
  reading.is_elsewhere = true;
  reading.keeps_time = !settings.follows_datagrams;
  reading.tables = {UdpRig::link_layout()};
  reading.make = [settings, address](double period_s) {
    UdpRig::Settings at_this_rate = settings;
    at_this_rate.control_period = from_seconds(period_s);
    return std::make_unique<UdpRig>(at_this_rate, std::make_unique<UdpPort>(address));
  };
  return reading;
}

RigReading read_replay_rig(Section& section, int actuators, const std::filesystem::path& directory) {
  const std::filesystem::path file = named_file(section, "recording", directory).value_or("");
  const bool holds = section.choice("at_end", {"fault", "hold"}, "fault") == 1;
  RigReading reading;
  reading.transfer_delay_s.assign(static_cast<std::size_t>(actuators), 0.0);
  reading.follows_commands = false;
  reading.make = [file, actuators, at_end = holds ? ReplayRig::AtEnd::hold : ReplayRig::AtEnd::fault](double) {
    return std::make_unique<ReplayRig>(read_measurement(file, actuators), at_end);
  };
  return reading;
}

/// Where the file says less than the rig's parts do.
void narrow(Section& section, RigRating& rating) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  rating.displacement_m = std::min(rating.displacement_m, section.number("displacement_m", kPositive, kNone));
  rating.velocity_m_per_s = std::min(rating.velocity_m_per_s, section.number("velocity_m_per_s", kPositive, kNone));
  rating.force_n = std::min(rating.force_n, section.number("force_n", kPositive, kNone));
  section.finish();
}

struct GeometryReading {
  Maker<SetupGeometry> make;
  int actuators = 0;
  double stroke_limit_m = 0.0;
};

GeometryReading read_linear_geometry(Section& section, int dofs) {
  const Eigen::MatrixXd matrix = section.matrix("matrix", 0, static_cast<std::size_t>(dofs));
  return {[matrix] { return std::make_unique<LinearGeometry>(matrix); }, static_cast<int>(matrix.rows())};
}

GeometryReading read_rigid_beam(Section& section, int dofs) {
  if (dofs != 2) {
    section.error("type", "a rigid beam has 2 interface degrees of freedom, displacement and rotation; found " +
                              std::to_string(dofs));
  }
  const Eigen::MatrixXd attachments = section.matrix("attachment_m", 2, 2);
  const Eigen::MatrixXd anchors = section.matrix("anchor_m", 2, 2);
  std::array<RigidBeam::Actuator, 2> actuators;
  for (Eigen::Index i = 0; i < 2; ++i) {
    actuators[static_cast<std::size_t>(i)] = {attachments.row(i).transpose(), anchors.row(i).transpose()};
  }
  return {[actuators] { return std::make_unique<RigidBeam>(actuators); }, 2};
}

GeometryReading read_geometry(Section section, int dofs) {
  const bool is_linear = section.choice("type", {"linear", "rigid_beam"}) == 0;
  GeometryReading reading = is_linear ? read_linear_geometry(section, dofs) : read_rigid_beam(section, dofs);
  Section limits = section.section_or_empty("actuator_limits");
  reading.stroke_limit_m = limits.number("stroke_m", kPositive, std::numeric_limits<double>::infinity());
  limits.finish();
  section.finish();
  return reading;
}

/// Of the degrees of freedom at rest, by virtual work: J^T K J.
Eigen::MatrixXd stiffness_behind(const SetupGeometry& geometry, const Eigen::MatrixXd& stiffness_n_per_m) {
  SiteMatrix jacobian{geometry.actuators(), geometry.dofs()};
  geometry.derivative(SiteVector::Zero(geometry.dofs()), jacobian);
  return jacobian.transpose() * stiffness_n_per_m * jacobian;
}

/// Over the actuators, that of the degrees of freedom given; with more actuators than those, the smallest.
Eigen::MatrixXd stiffness_of_actuators(const SetupGeometry& geometry, const Eigen::MatrixXd& stiffness_n_per_m) {
  SiteMatrix jacobian{geometry.actuators(), geometry.dofs()};
  geometry.derivative(SiteVector::Zero(geometry.dofs()), jacobian);
  const Eigen::MatrixXd inverse = Eigen::MatrixXd{jacobian}.completeOrthogonalDecomposition().pseudoInverse();
  const Eigen::MatrixXd stiffness = inverse.transpose() * stiffness_n_per_m * inverse;
  return 0.5 * (stiffness + stiffness.transpose());
}

/// A rig of which no more is known than how late it is.
std::unique_ptr<Rig> late_rig(const std::vector<double>& delay_s, double period_s, const Eigen::MatrixXd& stiffness) {
  std::vector<std::unique_ptr<TransferSystem>> transfer_systems;
  for (const double each_s : delay_s) {
    transfer_systems.push_back(std::make_unique<Delay>(from_seconds(each_s), from_seconds(period_s)));
  }
  return std::make_unique<SimulatedRig>(std::move(transfer_systems), std::make_unique<ElasticSpecimen>(stiffness),
                                        SensorNoise{}, from_seconds(period_s));
}

/// The rig, read in actuators, behind its geometry.
RigReading behind(const GeometryReading& geometry, int dofs, RigReading rig) {
  rig.make_specimen = {};
  // Each degree of freedom may hang on every actuator: the slowest counts.
  const double slowest_s = rig.transfer_delay_s.empty() ? 0.0 : std::ranges::max(rig.transfer_delay_s);
  rig.transfer_delay_s.assign(static_cast<std::size_t>(dofs), slowest_s);
  if (rig.stiffness_n_per_m) {
    rig.stiffness_n_per_m = [geometry, of_actuators = std::move(rig.stiffness_n_per_m)](double displacement_m) {
      return stiffness_behind(*geometry.make(), of_actuators(displacement_m));
    };
  }
  rig.make_linear = [geometry, make_linear = std::move(rig.make_linear)](double period_s, double displacement_m,
                                                                         const Eigen::MatrixXd& given) {
    auto made = geometry.make();
    auto actuators = make_linear(period_s, displacement_m, stiffness_of_actuators(*made, given));
    return std::make_unique<TransformedRig>(std::move(actuators), std::move(made));
  };
  rig.tables.push_back(TransformedRig::actuators_layout(geometry.actuators));
  rig.make = [geometry, make_rig = std::move(rig.make)](double period_s) {
    return std::make_unique<TransformedRig>(make_rig(period_s), geometry.make(), geometry.stroke_limit_m);
  };
  return rig;
}

}  // namespace

RigReading read_rig(Section section, int dofs, const std::filesystem::path& directory, int site) {
  const auto first_noise_stream = static_cast<std::uint64_t>(site) * 2 * kMaxSiteDofs;
  struct RigType {
    std::string name;
    std::function<RigReading(int actuators)> read;
  };
  const std::vector<RigType> types{
      {"simulated", [&](int actuators) { return read_simulated_rig(section, actuators, first_noise_stream); }},
      {"udp", [&](int actuators) { return read_udp_rig(section, actuators); }},
      {"replay", [&](int actuators) { return read_replay_rig(section, actuators, directory); }},
  };
  std::vector<std::string> names;
  for (const RigType& type : types) names.push_back(type.name);
  const RigType& type = types[section.choice("type", names)];

  std::optional<Section> rating = section.optional_section("rating");
  std::optional<GeometryReading> geometry;
  if (auto part = section.optional_section("geometry")) geometry = read_geometry(*part, dofs);
  RigReading reading = type.read(geometry ? geometry->actuators : dofs);
  reading.type = type.name;
  if (geometry) reading.rating = {};  // of actuators, which the degrees of freedom are not
  if (rating) narrow(*rating, reading.rating);
  if (!reading.make_linear) {
    reading.make_linear = [delay_s = reading.transfer_delay_s](double period_s, double, const Eigen::MatrixXd& given) {
      return late_rig(delay_s, period_s, given);
    };
  }
  section.finish();
  return geometry ? behind(*geometry, dofs, std::move(reading)) : reading;
}

}  // namespace hybridtest
