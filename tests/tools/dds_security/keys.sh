#!/bin/sh
# Writes keys and documents of DDS Security to the folder $1, by the names of ROS 2: one folder for each participant.
# Domains of the governance: 1 authenticates only, 2 signs datagrams, 3 encrypts datagrams, 4 encrypts data of topics,
# 5 is as `ros2 security` makes it, 6 authenticates and lets others in.
set -eu
mkdir -p "$1"
cd "$1"
ec='-newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes'

rule() { # DOMAIN OTHERS DISCOVERY RTPS METADATA DATA
    cat <<XML
<domain_rule><domains><id>$1</id></domains>
<allow_unauthenticated_participants>$2</allow_unauthenticated_participants>
<enable_join_access_control>true</enable_join_access_control>
<discovery_protection_kind>$3</discovery_protection_kind>
<liveliness_protection_kind>$3</liveliness_protection_kind>
<rtps_protection_kind>$4</rtps_protection_kind>
<topic_access_rules><topic_rule><topic_expression>*</topic_expression>
<enable_discovery_protection>$([ "$3" = NONE ] && echo false || echo true)</enable_discovery_protection>
<enable_liveliness_protection>$([ "$3" = NONE ] && echo false || echo true)</enable_liveliness_protection>
<enable_read_access_control>true</enable_read_access_control>
<enable_write_access_control>true</enable_write_access_control>
<metadata_protection_kind>$5</metadata_protection_kind>
<data_protection_kind>$6</data_protection_kind>
</topic_rule></topic_access_rules></domain_rule>
XML
}

governance() { #
    echo '<?xml version="1.0" encoding="UTF-8"?>'
    echo '<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_governance.xsd"><domain_access_rules>'
    rule 1 false NONE NONE NONE NONE
    rule 2 false NONE SIGN NONE NONE
    rule 3 false NONE ENCRYPT NONE NONE
    rule 4 false NONE NONE NONE ENCRYPT
    rule 5 false ENCRYPT SIGN ENCRYPT ENCRYPT
    rule 6 true NONE NONE NONE NONE
    echo '</domain_access_rules></dds>'
}

permissions() { # SUBJECT WRITES READS UNTIL
    cat <<XML
<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_permissions.xsd">
<permissions><grant name="$1"><subject_name>CN=$1</subject_name>
<validity><not_before>2024-01-01T00:00:00</not_before><not_after>$4T00:00:00</not_after></validity>
<allow_rule><domains><id_range><min>0</min><max>9</max></id_range></domains>
<publish><topics><topic>$2</topic></topics></publish>
<subscribe><topics><topic>$3</topic></topics></subscribe>
</allow_rule><default>DENY</default></grant></permissions></dds>
XML
}

sign() { # NAME AUTHORITY, from the standard input
    cat > document.xml
    openssl smime -sign -in document.xml -text -out "$1" -signer "$2.pem" -inkey "$2.key"
}

participant() { # NAME AUTHORITY WRITES READS UNTIL
    mkdir "$1"
    openssl req $ec -keyout "$1/key.pem" -out request.pem -subj "/CN=$1"
    openssl x509 -req -days 3650 -in request.pem -CA "$2.pem" -CAkey "$2.key" -CAcreateserial -out "$1/cert.pem"
    cp "$2.pem" "$1/identity_ca.cert.pem"
    cp "$2.pem" "$1/permissions_ca.cert.pem"
    governance | sign "$1/governance.p7s" "$2"
    permissions "$1" "$3" "$4" "$5" | sign "$1/permissions.p7s" "$2"
}

{
    for authority in ours theirs; do
        openssl req -x509 $ec -keyout "$authority.key" -out "$authority.pem" -days 3650 -subj "/CN=$authority"
    done
    participant alice ours '*' '*' 2036-01-01
    participant bob ours '*' '*' 2036-01-01
    participant reader ours other '*' 2036-01-01
    participant elsewhere ours other other 2036-01-01
    participant late ours '*' '*' 2025-01-01
    participant stranger theirs '*' '*' 2036-01-01
    # Permissions of another, and permissions that their holder extended.
    cp -r bob thief && cp alice/permissions.p7s thief/
    cp -r late forger && sed 's/2025-01-01/2036-01-01/' late/permissions.p7s > forger/permissions.p7s
} 2> openssl.log
