//! A list of every type, for tests over all of them; `golden.rs` checks that it is complete.

/// Calls the macro `$check` with each type.
macro_rules! for_every_type {
    ($check:ident) => {
        $check!(grainlab_msgs::builtin_interfaces::Duration);
        $check!(grainlab_msgs::builtin_interfaces::Time);
        $check!(grainlab_msgs::diagnostic_msgs::DiagnosticArray);
        $check!(grainlab_msgs::diagnostic_msgs::DiagnosticStatus);
        $check!(grainlab_msgs::diagnostic_msgs::KeyValue);
        $check!(grainlab_msgs::geometry_msgs::Point);
        $check!(grainlab_msgs::geometry_msgs::Pose);
        $check!(grainlab_msgs::geometry_msgs::Quaternion);
        $check!(grainlab_msgs::geometry_msgs::Transform);
        $check!(grainlab_msgs::geometry_msgs::TransformStamped);
        $check!(grainlab_msgs::geometry_msgs::Vector3);
        $check!(grainlab_msgs::msg::ContactStatistics);
        $check!(grainlab_msgs::msg::ElasticStiffness);
        $check!(grainlab_msgs::msg::EnergyBalance);
        $check!(grainlab_msgs::msg::Estimate);
        $check!(grainlab_msgs::msg::Fabric);
        $check!(grainlab_msgs::msg::ForceStatistics);
        $check!(grainlab_msgs::msg::Microstructure);
        $check!(grainlab_msgs::msg::MobilisedFriction);
        $check!(grainlab_msgs::msg::Moduli);
        $check!(grainlab_msgs::msg::OrientationFit);
        $check!(grainlab_msgs::msg::OrientationHistogram);
        $check!(grainlab_msgs::msg::OverlapAnisotropyFit);
        $check!(grainlab_msgs::msg::Packing);
        $check!(grainlab_msgs::msg::PackingChunk);
        $check!(grainlab_msgs::msg::PackingCredit);
        $check!(grainlab_msgs::msg::PackingReport);
        $check!(grainlab_msgs::msg::PrincipalAxis);
        $check!(grainlab_msgs::msg::RunState);
        $check!(grainlab_msgs::msg::StrainRate);
        $check!(grainlab_msgs::msg::StrainRatios);
        $check!(grainlab_msgs::msg::Stress);
        $check!(grainlab_msgs::msg::StressDecomposition);
        $check!(grainlab_msgs::msg::StressForceFabric);
        $check!(grainlab_msgs::msg::SubNetwork);
        $check!(grainlab_msgs::msg::SymmetricTensor);
        $check!(grainlab_msgs::msg::Symmetry);
        $check!(grainlab_msgs::msg::TransverseIsotropy);
        $check!(grainlab_msgs::msg::WaveSpeed);
        $check!(grainlab_msgs::msg::WaveSpeeds);
        $check!(grainlab_msgs::msg::Waveform);
        $check!(grainlab_msgs::rcl_interfaces::Log);
        $check!(grainlab_msgs::rcl_interfaces::Parameter);
        $check!(grainlab_msgs::rcl_interfaces::ParameterEvent);
        $check!(grainlab_msgs::rcl_interfaces::ParameterValue);
        $check!(grainlab_msgs::rosgraph_msgs::Clock);
        $check!(grainlab_msgs::sensor_msgs::CompressedImage);
        $check!(grainlab_msgs::sensor_msgs::PointCloud2);
        $check!(grainlab_msgs::sensor_msgs::PointField);
        $check!(grainlab_msgs::std_msgs::ColorRGBA);
        $check!(grainlab_msgs::std_msgs::Header);
        $check!(grainlab_msgs::tf2_msgs::TFMessage);
        $check!(grainlab_msgs::visualization_msgs::Marker);
        $check!(grainlab_msgs::visualization_msgs::MarkerArray);
        $check!(grainlab_msgs::visualization_msgs::MeshFile);
        $check!(grainlab_msgs::visualization_msgs::UVCoordinate);
    };
}
pub(crate) use for_every_type;
