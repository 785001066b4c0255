/* SPDX-License-Identifier: Apache-2.0 */
#include "console_tls.hpp"

#include <openssl/ssl.h>

namespace opms_host {

bool console_tls_load(boost::asio::ssl::context &context, const std::string &cert_path,
                      const std::string &key_path, std::string &error)
{
    using boost::asio::ssl::context_base;
    boost::system::error_code problem;
    context.set_options(context_base::default_workarounds | context_base::no_compression |
                            context_base::single_dh_use,
                        problem);
    SSL_CTX_set_min_proto_version(context.native_handle(), TLS1_2_VERSION);
    context.use_certificate_chain_file(cert_path, problem);
    if (problem) {
        error = cert_path + ": is no certificate in PEM form: " + problem.message();
        return false;
    }
    context.use_private_key_file(key_path, context_base::pem, problem);
    if (problem) {
        error = key_path + ": is no private key of that certificate in PEM form: " +
                problem.message();
        return false;
    }
    return true;
}

}  // namespace opms_host
