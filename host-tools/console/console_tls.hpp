/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Certificate and key of the server. */
#ifndef OPMS_CONSOLE_CONSOLE_TLS_HPP
#define OPMS_CONSOLE_CONSOLE_TLS_HPP

#include <string>

#include <boost/asio/ssl/context.hpp>

namespace opms_host {

/** TLS 1.2 and later. @return false with @p error, which names the file. */
bool console_tls_load(boost::asio::ssl::context &context, const std::string &cert_path,
                      const std::string &key_path, std::string &error);

}  // namespace opms_host
#endif
