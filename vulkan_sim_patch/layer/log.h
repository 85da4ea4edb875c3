// Lines the layer prints to stderr, each beginning with "a2rt-layer:".
#pragma once

#include <string>

namespace a2rt::layer {

enum class LogLevel { kQuiet, kWarn, kInfo, kDebug };

// Prints if `level` is at or below the level in force. Thread-safe; one write per line.
void log(LogLevel level, const std::string& message);
void set_log_level(LogLevel level);

inline void warn(const std::string& message) { log(LogLevel::kWarn, message); }
inline void info(const std::string& message) { log(LogLevel::kInfo, message); }
inline void debug(const std::string& message) { log(LogLevel::kDebug, message); }

}  // namespace a2rt::layer
